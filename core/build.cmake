# Compile options of all targets, the dependencies, and the include tree.

include(FetchContent)
include(GNUInstallDirs)

set(WINNOW_SHARED OFF)
if(BUILD_SHARED_LIBS)
  set(WINNOW_SHARED ON)
endif()

# winnow_public_name(OUT header): sets OUT to the path of a public header below <winnow/...>.
function(winnow_public_name out header)
  string(REGEX REPLACE "^pipeline/(winnow\\.h|c/)" "\\1" public ${header})
  set(${out} ${public} PARENT_SCOPE)
endfunction()

# The headers directly in a room's folder are public. Sources include them as <winnow/core/volumes.h>,
# as users do after installation: for each public header the build tree has a file that includes it.
# All other headers are included by their path from the root of the tree.
set(WINNOW_INCLUDE_DIR ${PROJECT_BINARY_DIR}/include)
set(WINNOW_PUBLIC_HEADERS "")
set(winnow_public_folders core simd partitions pipeline)
if(WINNOW_C)
  list(APPEND winnow_public_folders pipeline/c)
endif()
foreach(room ${winnow_public_folders})
  file(GLOB headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
       ${PROJECT_SOURCE_DIR}/${room}/*.h)
  list(APPEND WINNOW_PUBLIC_HEADERS ${headers})
endforeach()
foreach(header ${WINNOW_PUBLIC_HEADERS})
  winnow_public_name(public ${header})
  file(CONFIGURE OUTPUT ${WINNOW_INCLUDE_DIR}/winnow/${public}
       CONTENT "#include \"${PROJECT_SOURCE_DIR}/${header}\"\n" @ONLY)
endforeach()

find_package(Eigen3 3.4 QUIET NO_MODULE)
if(NOT TARGET Eigen3::Eigen)
  FetchContent_Declare(Eigen3
    URL https://gitlab.com/libeigen/eigen/-/archive/3.4.0/eigen-3.4.0.tar.gz
    URL_HASH SHA256=8586084f71f9bde545ee7fa6d00288b264a2b7ac3607b974e54d13e7162c1c72)
  FetchContent_MakeAvailable(Eigen3)
endif()

set(winnow_tbb "")
if(WINNOW_TBB)
  find_package(TBB 2021 QUIET CONFIG)
  if(NOT TARGET TBB::tbb)
    set(TBB_TEST OFF)
    FetchContent_Declare(TBB GIT_REPOSITORY https://github.com/oneapi-src/oneTBB.git
                         GIT_TAG v2021.8.0)
    FetchContent_MakeAvailable(TBB)
  endif()
  set(winnow_tbb TBB::tbb)
endif()

# Only the headers of xsimd are searched, because the CMake target of Debian's package links a
# library that Debian does not have.
find_path(WINNOW_XSIMD_INCLUDE_DIR xsimd/xsimd.hpp)
if(NOT WINNOW_XSIMD_INCLUDE_DIR)
  FetchContent_Declare(xsimd GIT_REPOSITORY https://github.com/xtensor-stack/xsimd.git
                       GIT_TAG 8.1.0)
  FetchContent_Populate(xsimd)
  set(WINNOW_XSIMD_INCLUDE_DIR ${xsimd_SOURCE_DIR}/include CACHE PATH "xsimd headers" FORCE)
endif()

add_library(winnow_flags INTERFACE)
target_include_directories(winnow_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_features(winnow_flags INTERFACE cxx_std_20)
# Sources compute with Eigen; public headers do not need it.
target_link_libraries(winnow_flags INTERFACE Eigen3::Eigen)
# Contraction to fused multiply-add would make results depend on the instruction set.
target_compile_options(winnow_flags INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -ffp-contract=off
  $<$<BOOL:${WINNOW_WARNINGS_AS_ERRORS}>:-Werror>)
# On AArch64, Eigen's vector code also uses fused multiply-add if __ARM_FEATURE_FMA is defined.
# Kernels keep the macro: they do not include Eigen, and use fused multiply-add only for bounds.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64|ARM64")
  target_compile_options(winnow_flags INTERFACE
    $<$<NOT:$<BOOL:$<TARGET_PROPERTY:WINNOW_KERNELS>>>:-U__ARM_FEATURE_FMA>)
endif()
if(WINNOW_COVERAGE)
  set(winnow_coverage --coverage)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    set(winnow_coverage -fprofile-instr-generate -fcoverage-mapping)
  endif()
  target_compile_options(winnow_flags INTERFACE ${winnow_coverage})
  target_link_options(winnow_flags INTERFACE ${winnow_coverage})
endif()
if(WINNOW_SANITIZER STREQUAL "address")
  set(winnow_sanitize -fsanitize=address,undefined -fno-sanitize-recover=all
      -fno-omit-frame-pointer)
  # The checks `alignment` and `null` take much of the run time of a build with this sanitizer.
  option(WINNOW_SANITIZE_POINTERS "Look for null and misaligned pointers before each use" ON)
  if(NOT WINNOW_SANITIZE_POINTERS)
    list(APPEND winnow_sanitize -fno-sanitize=alignment,null)
  endif()
elseif(WINNOW_SANITIZER STREQUAL "fuzzer")
  set(winnow_sanitize -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
      -fno-omit-frame-pointer)
elseif(WINNOW_SANITIZER STREQUAL "thread")
  set(winnow_sanitize -fsanitize=thread)
elseif(WINNOW_SANITIZER STREQUAL "memory")
  set(winnow_sanitize -fsanitize=memory -fsanitize-memory-track-origins -fno-omit-frame-pointer
      -fsanitize-ignorelist=${CMAKE_CURRENT_LIST_DIR}/memory_sanitizer.txt)
elseif(NOT WINNOW_SANITIZER STREQUAL "")
  message(FATAL_ERROR "WINNOW_SANITIZER is empty, address, fuzzer, memory or thread")
endif()
target_compile_options(winnow_flags INTERFACE ${winnow_sanitize})
target_link_options(winnow_flags INTERFACE ${winnow_sanitize})

# winnow_library(room LINKS ... PRIVATE_LINKS ... PRECOMPILED ... APART ...): adds one of the four
# rooms of the library, an archive of every source below its folder. A `*.kernel.cpp` is compiled
# once per instruction set. The other sources of a folder are compiled together (unity build),
# because most of their compile time is spent on headers, and programs link them together anyway.
# Sources in APART have local names that collide with names of other sources, and are compiled on
# their own.
function(winnow_library room)
  cmake_parse_arguments(arg "" "" "LINKS;PRIVATE_LINKS;PRECOMPILED;APART" ${ARGN})
  file(GLOB_RECURSE sources RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)
  # These folders have a CMakeLists.txt with libraries of their own.
  list(FILTER sources EXCLUDE REGEX "^(c|python|cluster/mpi)/")
  set(kernels ${sources})
  list(FILTER kernels INCLUDE REGEX "\\.kernel\\.cpp$")
  list(FILTER sources EXCLUDE REGEX "\\.kernel\\.cpp$")
  set(target winnow_${room})
  add_library(${target} STATIC ${sources})
  add_library(winnow::${room} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${room} POSITION_INDEPENDENT_CODE ON
                                             CXX_VISIBILITY_PRESET hidden
                                             VISIBILITY_INLINES_HIDDEN ON
                                             EXCLUDE_FROM_ALL ${WINNOW_SHARED}
                                             UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  foreach(source ${sources})
    get_filename_component(folder ${source} DIRECTORY)
    if(folder AND NOT source IN_LIST arg_APART)
      string(REPLACE "/" "_" group ${folder})
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
  # Lets programs that are linked with --gc-sections drop what they do not use.
  target_compile_options(${target} PRIVATE -ffunction-sections -fdata-sections)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${WINNOW_INCLUDE_DIR}>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PUBLIC ${arg_LINKS} PRIVATE $<BUILD_INTERFACE:winnow_flags>
                        ${arg_PRIVATE_LINKS})
  target_compile_definitions(${target} PRIVATE ${WINNOW_ISA_DEFINITIONS}
                             $<$<BOOL:${WINNOW_SHARED}>:WINNOW_SHARED=1>
                             $<$<BOOL:${WINNOW_SHARED}>:WINNOW_EXPORTS=1>)
  # Most of the compile time of a source is spent on Eigen's headers. Compiler caches work better
  # without a precompiled header.
  if(WINNOW_PRECOMPILED_HEADERS AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND arg_PRECOMPILED)
    target_precompile_headers(${target} PRIVATE ${arg_PRECOMPILED})
  endif()
  if(kernels)
    winnow_add_kernels(${target} ${kernels})
  endif()
endfunction()

# winnow::winnow, the target that simulations link: all rooms. A shared library contains the objects
# of all rooms and exports the names marked WINNOW_API. Tests and bench, which use internal names,
# link the archive winnow::pipeline, and with it all rooms below.
function(winnow_whole_library)
  if(NOT WINNOW_SHARED)
    add_library(winnow INTERFACE)
    target_link_libraries(winnow INTERFACE winnow_pipeline)
  else()
    get_property(kernels GLOBAL PROPERTY WINNOW_KERNEL_OBJECTS)
    add_library(winnow SHARED)
    foreach(objects winnow_core winnow_simd winnow_partitions winnow_pipeline ${kernels})
      target_sources(winnow PRIVATE $<TARGET_OBJECTS:${objects}>)
    endforeach()
    set_target_properties(winnow PROPERTIES
      LINKER_LANGUAGE CXX
      VERSION ${PROJECT_VERSION}
      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    target_compile_features(winnow INTERFACE cxx_std_20)
    target_compile_definitions(winnow INTERFACE WINNOW_SHARED=1)
    target_include_directories(winnow INTERFACE $<BUILD_INTERFACE:${WINNOW_INCLUDE_DIR}>
                               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_link_libraries(winnow PRIVATE winnow_flags ${winnow_tbb})
  endif()
  add_library(winnow::winnow ALIAS winnow)
endfunction()
