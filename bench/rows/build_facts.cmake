# Rewrites build_facts.cpp if its contents have changed. Runs as a script in every build (-DSOURCE,
# -DOUT and the facts), because the commit may have changed.
execute_process(COMMAND git -C ${SOURCE} -c safe.directory=* rev-parse --short=12 HEAD
                OUTPUT_VARIABLE WINNOW_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE
                RESULT_VARIABLE failed ERROR_QUIET)
if(failed)
  set(WINNOW_COMMIT "unknown")
else()
  execute_process(COMMAND git -C ${SOURCE} -c safe.directory=* status --porcelain
                          --untracked-files=no
                  OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    string(APPEND WINNOW_COMMIT "+")
  endif()
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/build_facts.cpp.in ${OUT} @ONLY)
