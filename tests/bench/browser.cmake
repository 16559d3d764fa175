# Opens pages in headless Chromium with a software renderer. Included by tests of pages that the
# tool writes; without a browser a test prints "skipped" and ends.
find_program(browser NAMES chromium-headless-shell chromium chromium-browser google-chrome)
if(NOT browser)
  message("skipped: no Chromium to open pages in (Debian: chromium-headless-shell)")
endif()

# look(<path of the page> <variable> [<fragment> [<width> <height>]]): returns the page after its
# scripts have run. Fails if the page logs an error. look_options are further options of the browser.
function(look path result)
  set(fragment check)
  set(size 900,600)
  if(ARGC GREATER 2)
    set(fragment ${ARGV2})
  endif()
  if(ARGC GREATER 4)
    set(size ${ARGV3},${ARGV4})
  endif()
  execute_process(
    COMMAND ${browser} --headless --no-sandbox --disable-dev-shm-usage --enable-unsafe-swiftshader
            --user-data-dir=${WORK}/profile --window-size=${size} --virtual-time-budget=2000 ${look_options}
            --enable-logging=stderr --dump-dom "file://${path}#${fragment}"
    TIMEOUT 300 RESULT_VARIABLE status OUTPUT_VARIABLE page ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${path}: the browser ended with ${status}: ${log}")
  endif()
  # Every console message counts as an error, except the driver's warning about slow pixel reads.
  string(REGEX MATCHALL "[^\n]*:CONSOLE:[^\n]*" complaints "${log}")
  list(FILTER complaints EXCLUDE REGEX "GL Driver Message \\(OpenGL, Performance")
  if(complaints)
    message(FATAL_ERROR "${path}: the page logged ${complaints}")
  endif()
  set(${result} "${page}" PARENT_SCOPE)
endfunction()
