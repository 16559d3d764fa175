# winnow_page(NAME FOLDER TITLE LIBRARIES <library>... SCRIPTS <script>...): compiles in a page as the text NAME:
# page.html with body.html, style.css and the scripts of the folder, in which variables such as @views@ are replaced.
# The JavaScript libraries are read when the tool writes a page.
function(winnow_page name folder title)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "" "LIBRARIES;SCRIPTS")
  set(page ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/page.html)
  set(elements ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/elements.js)
  list(TRANSFORM arg_LIBRARIES REPLACE "(.+)" "<script src=\"/usr/share/javascript/\\1\"></script>\n")
  list(JOIN arg_LIBRARIES "" libraries)
  file(READ ${page} text)
  file(READ ${folder}/body.html body)
  file(READ ${folder}/style.css style)
  list(TRANSFORM arg_SCRIPTS REPLACE "(.+)" "${folder}/\\1.js")
  foreach(script ${elements} ${arg_SCRIPTS})
    file(READ ${script} content)
    string(CONFIGURE "${content}" content @ONLY)
    string(APPEND scripts "<script>\n${content}</script>\n")
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
               ${page} ${folder}/body.html ${folder}/style.css ${elements} ${arg_SCRIPTS})
  string(CONFIGURE "${text}" text @ONLY)
  winnow_text(${name} "${text}")
endfunction()
file(READ ${CMAKE_CURRENT_LIST_DIR}/views.json views)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/views.json)
winnow_page(kResultsPage ${CMAKE_CURRENT_LIST_DIR} "winnow: results"
            LIBRARIES chart.js/chart.min.js SCRIPTS rows charts views page)
winnow_page(kDrawPage ${CMAKE_CURRENT_LIST_DIR}/../draw/page winnow
            LIBRARIES three/three.min.js three/examples/js/controls/OrbitControls.js
                      three/examples/js/lines/LineSegmentsGeometry.js three/examples/js/lines/LineMaterial.js
                      three/examples/js/lines/LineSegments2.js
            SCRIPTS data meshes layers view picking legend player main)
