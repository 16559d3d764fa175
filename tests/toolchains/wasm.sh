# shellcheck shell=bash
# Sourced by scripts that build for WebAssembly on a Debian machine: the packages and headers.

WINNOW_WASM_PACKAGES=(clang-16 lld-16 llvm-16 libclang-rt-16-dev-wasm32 libc++-16-dev-wasm32
  libc++abi-16-dev-wasm32 wasi-libc nodejs)

# winnow_wasm_root FOLDER: fills FOLDER with the headers that implement the SSE intrinsics in
# emscripten. The rest of that package is neither used nor installed.
winnow_wasm_root() {
  local root=$1
  [[ -e "$root/complete" ]] && return
  mkdir -p "$root/deb"
  (cd "$root/deb" && { apt-get download emscripten || {
    apt-get update && apt-get download emscripten; }; }) >"$root/log" 2>&1 ||
    { cat "$root/log" >&2 && return 1; }
  dpkg-deb --fsys-tarfile "$root"/deb/emscripten_*.deb |
    tar -x -C "$root" --strip-components=7 ./usr/share/emscripten/system/include/compat || return 1
  # Eigen also includes the MMX header.
  : >"$root/mmintrin.h"
  rm -rf "$root/deb"
  touch "$root/complete"
}
