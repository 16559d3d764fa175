# Compiles each kernel file once per instruction set.

# WINNOW_ISAS lists the instruction sets for which kernels are compiled, narrowest first. On x86-64
# it must contain sse42, for which all other code is compiled. A program uses the widest one that
# its machine has. Each instruction set adds a copy of the kernels to programs, and time to the
# build. On x86-64, "native" is the baseline and the widest set that this machine runs; kernels of
# the baseline are then compiled with -O1, because this machine does not use them by default.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  set(WINNOW_ISAS "sse42;avx2;avx512" CACHE STRING "Instruction sets to build kernels for")
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64|ARM64")
  set(WINNOW_ISAS "neon64" CACHE STRING "Instruction sets to build kernels for")
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "wasm")
  # The compiler's headers provide SSE4.2 intrinsics; see tests/toolchains/wasm.cmake.
  set(WINNOW_ISAS "sse42" CACHE STRING "Instruction sets to build kernels for")
else()
  message(FATAL_ERROR "winnow has no kernels for ${CMAKE_SYSTEM_PROCESSOR}")
endif()
# winnow_native_isas(): sets WINNOW_ISAS to the list that "native" stands for.
function(winnow_native_isas)
  if(CMAKE_CROSSCOMPILING)
    message(FATAL_ERROR "WINNOW_ISAS=native queries this machine, and this build is for another")
  endif()
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
    set(WINNOW_ISAS neon64 PARENT_SCOPE)
    return()
  endif()
  include(CheckCXXSourceRuns)
  set(runs "int main() { return __builtin_cpu_supports")
  set(and "&& __builtin_cpu_supports")
  check_cxx_source_runs("${runs}(\"avx2\") ${and}(\"fma\") ? 0 : 1; }" WINNOW_RUNS_AVX2)
  check_cxx_source_runs("${runs}(\"avx512f\") ${and}(\"avx512cd\") ${and}(\"avx512dq\") \
${and}(\"avx512bw\") ${and}(\"avx512vl\") ? 0 : 1; }" WINNOW_RUNS_AVX512)
  if(WINNOW_RUNS_AVX512)
    set(WINNOW_ISAS "sse42;avx512" PARENT_SCOPE)
  elseif(WINNOW_RUNS_AVX2)
    set(WINNOW_ISAS "sse42;avx2" PARENT_SCOPE)
  else()
    set(WINNOW_ISAS sse42 PARENT_SCOPE)
  endif()
endfunction()

set(WINNOW_FLAGS_sse42 "")
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "wasm")
  set(WINNOW_FLAGS_sse42 -msse4.2 -mpopcnt)
endif()
set(WINNOW_FLAGS_avx2 -mavx2 -mfma -mbmi -mbmi2 -mpopcnt -mlzcnt)
set(WINNOW_FLAGS_avx512 -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl -mavx2 -mfma -mbmi
    -mbmi2 -mpopcnt -mlzcnt -mprefer-vector-width=512)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Intrinsics of g++ 12 pass a register that is uninitialised on purpose.
  list(APPEND WINNOW_FLAGS_avx512 -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
set(WINNOW_FLAGS_neon64 "")

set(winnow_native OFF)
if(WINNOW_ISAS STREQUAL "native")
  set(winnow_native ON)
  winnow_native_isas()
endif()
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64" AND NOT "sse42" IN_LIST WINNOW_ISAS)
  message(FATAL_ERROR "WINNOW_ISAS must contain the baseline sse42")
endif()

set(WINNOW_ISA_DEFINITIONS "")
foreach(isa ${WINNOW_ISAS})
  if(NOT DEFINED WINNOW_FLAGS_${isa})
    message(FATAL_ERROR "unknown instruction set in WINNOW_ISAS: ${isa}")
  endif()
  string(TOUPPER ${isa} upper)
  list(APPEND WINNOW_ISA_DEFINITIONS WINNOW_HAVE_${upper}=1)
endforeach()

set(WINNOW_KERNEL_OPTIMIZATION -O3 CACHE STRING "Optimization of kernels in every build type")
# A value of type Lanes takes two registers on AVX2 and four on SSE4.2, which makes compilation
# slow.
set(WINNOW_NARROWER_OPTIMIZATION "" CACHE STRING
    "Optimization of kernels for all instruction sets but the widest; empty: that of all kernels")
set(WINNOW_KERNELS_FROM "" CACHE PATH
    "Folder of another build, with the same instruction sets, whose kernels are linked; empty: none")
if(winnow_native AND NOT WINNOW_NARROWER_OPTIMIZATION)
  set(WINNOW_NARROWER_OPTIMIZATION -O1)
endif()
mark_as_advanced(WINNOW_KERNEL_OPTIMIZATION WINNOW_NARROWER_OPTIMIZATION WINNOW_KERNELS_FROM)
list(GET WINNOW_ISAS -1 winnow_widest_isa)

# winnow_add_kernels(target file.kernel.cpp ...): compiles each file into an object library per
# instruction set, and links these into the target. The macro xsimd=xsimd_<isa> gives every build
# its own xsimd namespace, so no inline function is shared between them. Kernels do not depend on
# how other sources are compiled: builds with other options for these may link the kernels of
# another build (WINNOW_KERNELS_FROM).
function(winnow_add_kernels target)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  foreach(isa ${WINNOW_ISAS})
    set(objects ${target}_kernels_${isa})
    if(WINNOW_KERNELS_FROM)
      foreach(source ${ARGN})
        set(object ${WINNOW_KERNELS_FROM}/${folder}/CMakeFiles/${objects}.dir/${source}.o)
        set_source_files_properties(${object} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
        target_sources(${target} PRIVATE ${object})
      endforeach()
      continue()
    endif()
    add_library(${objects} OBJECT ${ARGN})
    set(optimization ${WINNOW_KERNEL_OPTIMIZATION})
    if(WINNOW_NARROWER_OPTIMIZATION AND NOT isa STREQUAL winnow_widest_isa)
      set(optimization ${WINNOW_NARROWER_OPTIMIZATION})
    endif()
    target_compile_options(${objects} PRIVATE ${WINNOW_FLAGS_${isa}} -fno-exceptions
                           ${optimization})
    target_compile_definitions(${objects} PRIVATE WINNOW_ISA_NAME=${isa} WINNOW_ISA_IS_${isa}=1
                               xsimd=xsimd_${isa})
    target_include_directories(${objects} PRIVATE ${WINNOW_INCLUDE_DIR} ${PROJECT_SOURCE_DIR})
    target_include_directories(${objects} SYSTEM PRIVATE ${WINNOW_XSIMD_INCLUDE_DIR})
    target_link_libraries(${objects} PRIVATE winnow_flags)
    set_target_properties(${objects} PROPERTIES WINNOW_KERNELS ON
                                                POSITION_INDEPENDENT_CODE ON
                                                CXX_VISIBILITY_PRESET hidden
                                                VISIBILITY_INLINES_HIDDEN ON)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
    set_property(GLOBAL APPEND PROPERTY WINNOW_KERNEL_OBJECTS ${objects})
  endforeach()
endfunction()
