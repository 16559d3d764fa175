"""winnow for Spack: run `spack repo add bench/packaging/spack`, then
`spack dev-build winnow@0.1.0` in winnow's source tree."""

from spack.package import CMakePackage, depends_on, license, variant, version


class Winnow(CMakePackage):
    """Collision detection: bounding volumes to overlapping pairs to contacts."""

    license("MIT")

    version("0.1.0")

    variant("shared", default=False, description="One shared library instead of archives")
    variant("tbb", default=True, description="Parallel work on oneTBB")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("xsimd@8.1:14", type="build")
    depends_on("eigen@3.4:3")
    depends_on("intel-oneapi-tbb@2021:", when="+tbb")

    def cmake_args(self):
        return [
            self.define("WINNOW_TESTS", False),
            self.define("WINNOW_BENCH", False),
            self.define("WINNOW_CLUSTER", False),
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define_from_variant("WINNOW_TBB", "tbb"),
        ]
