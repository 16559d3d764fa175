# Cross-compiles for Windows on x86-64 with Debian's g++-mingw-w64-x86-64-posix; tests run under
# Wine. Only SSE4.2: g++ does not align the stack for wider vectors there
# (https://gcc.gnu.org/bugzilla/show_bug.cgi?id=54412).
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR AMD64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_CROSSCOMPILING_EMULATOR wine)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(WINNOW_ISAS sse42 CACHE STRING "")

include(${CMAKE_CURRENT_LIST_DIR}/host_headers.cmake)
