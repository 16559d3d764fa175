# winnow_page(NAME HTML): writes NAME.cpp, which defines the text of a page as the constant NAME, with the
# style sheet and the scripts that are beside it. Scripts with an absolute path, which are libraries, are
# read when the tool writes a page.
function(winnow_page name html)
  get_filename_component(folder ${html} DIRECTORY)
  file(READ ${html} text)
  string(REGEX MATCHALL "\"[a-z_]+[.](css|js)\"" files "${text}")
  foreach(file IN LISTS files)
    string(REPLACE "\"" "" file ${file})
    file(READ ${folder}/${file} content)
    string(REPLACE "<link rel=\"stylesheet\" href=\"${file}\">" "<style>\n${content}</style>" text "${text}")
    string(REPLACE "<script src=\"${file}\"></script>" "<script>\n${content}</script>" text "${text}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/${file})
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${html})
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp @ONLY CONTENT "#include \"bench/pages/page.h\"
namespace winnow::bench {
const char* const @name@ = R\"winnow(@text@)winnow\";
}
")
endfunction()
winnow_page(kResultsPage ${CMAKE_CURRENT_LIST_DIR}/index.html)
winnow_page(kDrawPage ${CMAKE_CURRENT_LIST_DIR}/../draw/page/index.html)
