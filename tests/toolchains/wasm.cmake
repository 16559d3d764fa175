# Cross-compiles to WebAssembly with Debian's clang 16 and library for WASI; programs run under
# Node. The folder build/wasm-root, which wasm.sh fills, has headers that implement SSE4.2 with the
# 128-bit vectors of WebAssembly. Eigen uses them as well, so that sums are added in the same order
# as on other machines.
set(CMAKE_SYSTEM_NAME WASI)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_C_COMPILER clang-16)
set(CMAKE_CXX_COMPILER clang++-16)
set(CMAKE_C_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_AR llvm-ar-16)
set(CMAKE_RANLIB llvm-ranlib-16)
set(CMAKE_CROSSCOMPILING_EMULATOR node --no-warnings ${CMAKE_CURRENT_LIST_DIR}/wasi.mjs)
set(CMAKE_EXECUTABLE_SUFFIX .wasm)

set(winnow_wasm_root ${CMAKE_CURRENT_LIST_DIR}/../../build/wasm-root)
if(NOT EXISTS ${winnow_wasm_root}/complete)
  message(FATAL_ERROR "no build/wasm-root: see tests/toolchains/wasm.sh")
endif()
set(winnow_wasm_flags "--sysroot=/ -isystem ${winnow_wasm_root} -isystem /usr/include/wasm32-wasi \
-msimd128 -D__SSE__ -D__SSE2__ -D__SSE3__ -D__SSSE3__ -D__SSE4_1__ -D__SSE4_2__")
set(CMAKE_C_FLAGS_INIT "${winnow_wasm_flags}")
# Without the first three options Boost derives from std::unary_function, which libc++ has removed,
# and includes a header of mutexes, which WASI lacks. Because this compiler does not claim to be
# g++, Boost uses Microsoft's syntax for alignment, which -fdeclspec accepts.
set(winnow_wasm_boost "-DBOOST_NO_CXX98_FUNCTION_BASE -DBOOST_DISABLE_THREADS \
-DBOOST_SMART_PTR_DETAIL_LIGHTWEIGHT_MUTEX_HPP_INCLUDED -fdeclspec")
# A throw ends the program. For a compiler that claims to be g++, Eigen uses x86 assembler.
# Googletest would capture output with calls that WASI lacks.
set(CMAKE_CXX_FLAGS_INIT "-nostdinc++ -isystem /usr/lib/llvm-16/include/wasm32-wasi/c++/v1 \
${winnow_wasm_flags} -fignore-exceptions -fgnuc-version=0 -DGTEST_HAS_STREAM_REDIRECTION=0 \
${winnow_wasm_boost}")
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-L/usr/lib/llvm-16/lib/wasm32-wasi -L/usr/lib/wasm32-wasi -Wl,-z,stack-size=4194304")

include(${CMAKE_CURRENT_LIST_DIR}/host_headers.cmake)
