# Included by toolchains of platforms without Debian packages: Eigen, xsimd and Boost consist of
# headers only, so the headers of this machine are used. Other libraries must not be found.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/host_headers)
foreach(headers xsimd boost)
  file(CREATE_LINK /usr/include/${headers} ${CMAKE_BINARY_DIR}/host_headers/${headers} SYMBOLIC)
endforeach()
set(WINNOW_XSIMD_INCLUDE_DIR ${CMAKE_BINARY_DIR}/host_headers CACHE PATH "xsimd headers")
set(WINNOW_BOOST_INCLUDE_DIR ${CMAKE_BINARY_DIR}/host_headers CACHE PATH "")
set(Eigen3_DIR /usr/share/eigen3/cmake CACHE PATH "Eigen's CMake files")
set(WINNOW_TBB OFF CACHE BOOL "")
set(CMAKE_DISABLE_FIND_PACKAGE_MPI ON)
set(WINNOW_RAPIDCHECK OFF CACHE BOOL "")
# Tests are built with the sources of Debian's googletest.
set(CMAKE_DISABLE_FIND_PACKAGE_GTest ON)
set(FETCHCONTENT_SOURCE_DIR_GOOGLETEST /usr/src/googletest CACHE PATH "")
