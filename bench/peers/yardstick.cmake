# The yardstick: a prototype of a blocked sweep (sg3.h) in a separate folder, which needs AVX-512,
# to measure partitions against. Without that folder it is left out. Like the other libraries it is
# built for this machine, in a shared library that exports one function.
set(WINNOW_YARDSTICK "${PROJECT_SOURCE_DIR}/../shared/yardstick" CACHE PATH
    "A folder with the prototype to measure partitions against, if there is one")

include(CheckCXXSourceCompiles)
set(CMAKE_REQUIRED_FLAGS -march=native)
check_cxx_source_compiles("
#if !defined(__AVX512F__) || !defined(__AVX512VL__) || !defined(__AVX512BW__)
#error
#endif
  int main() {}" WINNOW_NATIVE_AVX512)
unset(CMAKE_REQUIRED_FLAGS)

if(NOT WINNOW_NATIVE_AVX512 OR CMAKE_CROSSCOMPILING OR NOT EXISTS ${WINNOW_YARDSTICK}/sg3.h)
  add_library(winnow_yardstick STATIC yardstick.cpp)  # its factory returns null
  target_link_libraries(winnow_yardstick PUBLIC winnow::pipeline PRIVATE winnow_flags)
  return()
endif()
message(STATUS "winnow: can be measured against the yardstick")
add_library(winnow_yardstick SHARED yardstick.cpp)
target_compile_definitions(winnow_yardstick PRIVATE
                           WINNOW_HAVE_YARDSTICK=1 NDEBUG EIGEN_MAX_ALIGN_BYTES=16)
target_compile_options(winnow_yardstick PRIVATE
                       -O3 -march=native -mprefer-vector-width=512 -w)
target_include_directories(winnow_yardstick SYSTEM PRIVATE ${WINNOW_YARDSTICK})
target_link_libraries(winnow_yardstick PUBLIC winnow::pipeline PRIVATE winnow_flags TBB::tbb)
target_link_options(winnow_yardstick PRIVATE
                    LINKER:--version-script=${CMAKE_CURRENT_SOURCE_DIR}/yardstick_exports.map)
set_property(TARGET winnow_yardstick APPEND PROPERTY LINK_DEPENDS
             ${CMAKE_CURRENT_SOURCE_DIR}/yardstick_exports.map)
