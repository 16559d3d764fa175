"""winnow for Conan 2: run `conan create bench/packaging/conan` in winnow's source tree."""

import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir

ROOT = os.path.join("..", "..", "..")


class Winnow(ConanFile):
    name = "winnow"
    description = "Collision detection: bounding volumes to overlapping pairs to contacts"
    license = "MIT"
    topics = ("collision-detection", "broad-phase", "simd", "physics")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "shared": [True, False],
        "fPIC": [True, False],
        "tbb": [True, False],
    }
    default_options = {"shared": False, "fPIC": True, "tbb": True}
    implements = ["auto_shared_fpic"]

    def set_version(self):
        lists = load(self, os.path.join(self.recipe_folder, ROOT, "CMakeLists.txt"))
        self.version = re.search(r"project\(winnow VERSION ([0-9.]+)", lists).group(1)

    def export_sources(self):
        root = os.path.join(self.recipe_folder, ROOT)
        for part in ("CMakeLists.txt", "LICENSE", "core/*", "simd/*", "partitions/*", "pipeline/*"):
            copy(self, part, src=root, dst=self.export_sources_folder)

    def requirements(self):
        self.requires("eigen/3.4.0", transitive_headers=True)
        self.requires("xsimd/13.0.0", visible=False)
        if self.options.tbb:
            self.requires("onetbb/2021.12.0")

    def validate(self):
        check_min_cppstd(self, 20)

    def build_requirements(self):
        self.tool_requires("cmake/[>=3.25]")

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["WINNOW_TESTS"] = False
        toolchain.cache_variables["WINNOW_BENCH"] = False
        toolchain.cache_variables["WINNOW_CLUSTER"] = False
        toolchain.cache_variables["WINNOW_TBB"] = bool(self.options.tbb)
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        # CMakeDeps and PkgConfigDeps generate these files.
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "winnow")
        self.cpp_info.set_property("cmake_target_name", "winnow::winnow")
        self.cpp_info.set_property("pkg_config_name", "winnow")
        if self.options.shared:
            self.cpp_info.libs = ["winnow"]
            self.cpp_info.defines = ["WINNOW_SHARED=1"]
        else:
            self.cpp_info.libs = ["winnow_pipeline", "winnow_partitions", "winnow_simd",
                                  "winnow_core"]
        if self.settings.os == "Linux":
            self.cpp_info.system_libs = ["pthread"]
