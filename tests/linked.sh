# shellcheck shell=bash
# Sourced by tests/coverage/run and tests/mutants/run: tests that are built already, linked with another
# build of the library.

# winnow_link_tests BUILD LIBRARY OUT PROGRAM...: programs of a build folder, as tests/winnow_core_tests,
# by their own commands to link but with the archives of the build folder LIBRARY in place of theirs, into
# the folder OUT. WINNOW_LINKER names another compiler to link with, and WINNOW_LINK_FIRST what comes
# before everything else.
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
