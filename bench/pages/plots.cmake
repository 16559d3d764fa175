# Embeds the files of the plots in the tool and finds Chart.js. Chart.js is not part of winnow: the
# tool reads the installed file when it writes a page.
find_file(WINNOW_CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js)
if(NOT WINNOW_CHART_JS)
  message(STATUS "plots of winnow: Chart.js is not installed (Debian: libjs-chart.js)")
  set(WINNOW_CHART_JS /usr/share/javascript/chart.js/chart.min.js)
endif()
file(READ ${CMAKE_CURRENT_LIST_DIR}/plots.css WINNOW_PLOT_STYLE)
file(READ ${CMAKE_CURRENT_LIST_DIR}/plots.js WINNOW_PLOT_SCRIPT)
file(READ ${CMAKE_CURRENT_LIST_DIR}/chart_js_notice.html WINNOW_PLOT_NOTICE)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
             ${CMAKE_CURRENT_LIST_DIR}/plots.css ${CMAKE_CURRENT_LIST_DIR}/plots.js
             ${CMAKE_CURRENT_LIST_DIR}/chart_js_notice.html)
configure_file(${CMAKE_CURRENT_LIST_DIR}/plot_parts.cpp.in plot_parts.cpp @ONLY)
