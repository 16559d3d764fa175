# Pages in headless Chromium with a software renderer: included by tests of what the tool writes,
# which say so and end if there is no browser.
find_program(browser NAMES chromium-headless-shell chromium chromium-browser google-chrome)
if(NOT browser)
  message("skipped: no Chromium to open pages in (Debian: chromium-headless-shell)")
endif()

# look(<path of the page> <variable> [<fragment> [<width> <height>]]): the page as it stands once its
# scripts have run. Fails if it logs a complaint.
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
            --user-data-dir=${WORK}/profile --window-size=${size} --virtual-time-budget=2000
            --enable-logging=stderr --dump-dom "file://${path}#${fragment}"
    TIMEOUT 120 RESULT_VARIABLE status OUTPUT_VARIABLE page ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${path}: the browser ended with ${status}: ${log}")
  endif()
  # Of what the page logs only the driver's word on the speed of reading pixels is no complaint.
  string(REGEX MATCHALL "[^\n]*:CONSOLE:[^\n]*" complaints "${log}")
  list(FILTER complaints EXCLUDE REGEX "GL Driver Message \\(OpenGL, Performance")
  if(complaints)
    message(FATAL_ERROR "${path}: the page logged ${complaints}")
  endif()
  set(${result} "${page}" PARENT_SCOPE)
endfunction()
