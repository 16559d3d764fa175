# Embeds the files of the page in the tool and finds three.js. three.js is not part of winnow: the
# tool reads the installed file when it writes a page.
find_path(WINNOW_THREE_JS_FOLDER three.min.js
          PATHS /usr/share/javascript/three /usr/share/nodejs/three/build)
if(NOT WINNOW_THREE_JS_FOLDER)
  message(STATUS "winnow view: three.js is not installed (Debian: libjs-three)")
  set(WINNOW_THREE_JS_FOLDER /usr/share/javascript/three)
endif()

set(winnow_page ${CMAKE_CURRENT_LIST_DIR}/page)
set(winnow_page_scripts data.js meshes.js layers.js view.js picking.js legend.js player.js
    main.js)
file(READ ${winnow_page}/style.css WINNOW_PAGE_STYLE)
file(READ ${winnow_page}/body.html WINNOW_PAGE_BODY)
file(READ ${winnow_page}/three_js_notice.html WINNOW_PAGE_NOTICE)
set(WINNOW_PAGE_SCRIPT "")
foreach(script ${winnow_page_scripts})
  file(READ ${winnow_page}/${script} text)
  string(APPEND WINNOW_PAGE_SCRIPT "${text}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${winnow_page}/${script})
endforeach()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
             ${winnow_page}/style.css ${winnow_page}/body.html
             ${winnow_page}/three_js_notice.html)
configure_file(${CMAKE_CURRENT_LIST_DIR}/page_parts.cpp.in page_parts.cpp @ONLY)
