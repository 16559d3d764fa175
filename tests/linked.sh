# shellcheck shell=bash
# Sourced by tests/coverage/run and tests/mutants/run: links tests that are already compiled with
# another build of the library.

# winnow_link_tests BUILD LIBRARY OUT PROGRAM...: links programs of a build folder, such as
# tests/winnow_core_tests, into the folder OUT, with their own link commands but with the archives
# of the build folder LIBRARY. WINNOW_LINKER names another compiler for linking, and
# WINNOW_LINK_FIRST contains arguments that come first.
winnow_link_tests() {
  local tests=$1 library=$2 out=$3 program name command
  shift 3
  mkdir -p "$out"
  for program in "$@"; do
    name=${program##*/}
    command=$(ninja -C "$tests" -t commands "$program" | tail -n 1 |
      sed -E "s#(^| )((core|simd|partitions|pipeline)/libwinnow_[a-z]+\\.a)#\\1$library/\\2#g
              s#-o $program#-o $out/$name#
              s#^: && ([^ ]+)#: \\&\\& ${WINNOW_LINKER:-\\1} ${WINNOW_LINK_FIRST:-}#")
    (cd "$tests" && winnow_quietly "$out/$name.log" bash -c "$command")
  done
}
