# Packages of the installed files: `cpack --config BUILD/CPackConfig.cmake` writes a .deb for Debian
# 12 and its derivatives, and a .tar.gz that can be unpacked anywhere.

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_VENDOR "The winnow authors")
set(CPACK_PACKAGE_CONTACT "The winnow authors")
set(CPACK_PACKAGE_DESCRIPTION
    "A C++20 collision-detection engine: bounding volumes in partitions that prune with SIMD,
exact contacts of convex shapes, meshes, height fields and compounds, and scenes that
carry them over from frame to frame. With headers, CMake and pkg-config files.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)

# The tool, if it is built, is a separate package: it has more dependencies than the library.
set(CPACK_DEB_COMPONENT_INSTALL ON)
# All components are listed, because the package of a single component would get the name of the
# project.
get_cmake_property(CPACK_COMPONENTS_ALL COMPONENTS)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libwinnow-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(winnow_deb_of_tbb "libtbb-dev (>= 2021)")
set(winnow_deb_depends "")
foreach(library ${winnow_requires})
  list(APPEND winnow_deb_depends ${winnow_deb_of_${library}})
endforeach()
list(JOIN winnow_deb_depends ", " winnow_deb_depends)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ${winnow_deb_depends})
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION ${CPACK_PACKAGE_DESCRIPTION})
set(CPACK_DEBIAN_TOOL_PACKAGE_NAME winnow)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOL_PACKAGE_RECOMMENDS "libjs-chart.js, libjs-three")
set(CPACK_COMPONENT_TOOL_DESCRIPTION
    "The winnow tool: which partition to take for a recording of yours, and how fast and how
exact all of them are on this machine.")
# Adds the libraries that the tool and a shared library are linked to as dependencies of the
# packages.
find_program(WINNOW_DPKG_SHLIBDEPS dpkg-shlibdeps)
if(WINNOW_DPKG_SHLIBDEPS)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
endif()

include(CPack)
