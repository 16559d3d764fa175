# Compares the counts that `winnow view` prints with the picture that a browser draws.
# cmake -DWINNOW=<the tool> -DRECORD_PILE=<record_pile> -DWORK=<folder> -P pages.cmake
#
# Opens each page, with check.js, in headless Chromium with a software renderer. check.js reports how much the page
# sent to the graphics card, how many pixels are coloured, and how the picture changes when layers are
# switched and an object is pointed at.
cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/../browser.cmake)
if(NOT browser)
  return()
endif()
file(MAKE_DIRECTORY ${WORK})

# draw(<name of the page> <arguments of winnow view>...): writes <name>.html and <name>.json.
function(draw name)
  execute_process(
    COMMAND ${WINNOW} view ${ARGN} --out ${WORK}/${name}.html --json ${WORK}/${name}.json
    RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE error)
  if(error MATCHES "libjs-three")
    message("skipped: ${error}")
  endif()
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "winnow view ${ARGN}: ${error}")
  endif()
endfunction()

file(READ ${CMAKE_CURRENT_LIST_DIR}/check.js check)

# open(<name of the page> <variable>): returns the report that check.js writes.
function(open name report)
  file(READ ${WORK}/${name}.html text)
  string(REPLACE "</body>" "<script>\n${check}</script>\n</body>" text "${text}")
  file(WRITE ${WORK}/checked.html "${text}")
  look(${WORK}/checked.html page)
  if(NOT page MATCHES "id=\"report\">([^<]+)<")
    message(FATAL_ERROR "${name}: the page contains no report")
  endif()
  set(${report} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

# expect_same(<name> <drawn> <counts>): compares all numbers that both the page and the tool report.
function(expect_same name drawn counts)
  foreach(key objects_drawn pairs_drawn contacts structure_lines rays rays_that_hit ray_hits boxes inside
              crossing)
    string(JSON expected GET "${counts}" ${key})
    string(JSON got ERROR_VARIABLE missing GET "${drawn}" ${key})
    if(missing)
      set(got 0)
    endif()
    if(NOT got EQUAL expected)
      message(FATAL_ERROR "${name}: ${key} is ${expected}, the page drew ${got}")
    endif()
  endforeach()
  string(JSON expected GET "${counts}" structure)
  string(JSON got GET "${drawn}" structure)
  string(JSON same EQUAL "${expected}" "${got}")
  if(NOT same)
    message(FATAL_ERROR "${name}: the structure is ${expected}, the page drew ${got}")
  endif()
endfunction()

# expect_picture(<name> <report>): fails if the picture is blank or the page reports an error.
function(expect_picture name report)
  string(JSON errors GET "${report}" errors)
  string(JSON complaints LENGTH "${report}" errors)
  if(complaints)
    message(FATAL_ERROR "${name}: ${errors}")
  endif()
  string(JSON colours GET "${report}" pixels colours)
  string(JSON drawn GET "${report}" pixels drawn)
  string(JSON error GET "${report}" pixels error)
  if(colours LESS 100 OR drawn LESS 30000 OR NOT error EQUAL 0)
    message(FATAL_ERROR "${name}: a blank picture: ${report}")
  endif()
  string(JSON left GET "${report}" withoutLayers)
  if(NOT left EQUAL 0)
    message(FATAL_ERROR "${name}: ${left} pixels stay when every layer is switched off")
  endif()
endfunction()

function(check name)
  draw(${name} ${ARGN})
  file(READ ${WORK}/${name}.json counts)
  open(${name} report)
  string(JSON drawn GET "${report}" drawn)
  expect_same(${name} "${drawn}" "${counts}")
  expect_picture(${name} "${report}")
  message("${name}: ${drawn}")
  string(JSON pointed_at GET "${report}" pointedAt)
  set(pointed_at "${pointed_at}" PARENT_SCOPE)
endfunction()

set(questions --ray -2,4,4,1,0.05,0.02 --ray 5,5,30,0,0,-1 --ray 0,0,90,1,0,0 --box 2,2,2,7,6,5)
check(grid uniform --objects 400 --frame 3 --partition FlatGrid ${questions})
check(strips pile --objects 600 --frame 2 --partition SweepAndPrune ${questions})
check(tree mixed --objects 1000 --partition LinearBvh --max-depth 1 --max-objects 300 ${questions})
check(plain wall --objects 200 --partition NSquared)

# Checks frames that are played in sequence.
check(played respawn --objects 300 --frame 2 --frames 12 --partition HierarchicalGrid ${questions})
open(played report)
string(JSON frames GET "${report}" frames)
string(JSON wrong GET "${report}" wrongFrames)
if(NOT frames EQUAL 12 OR NOT wrong EQUAL 0)
  message(FATAL_ERROR "played: ${frames} frames of 12, ${wrong} of them are not what was drawn")
endif()

# Checks the contacts in each frame of a recording that a program made of a scene.
execute_process(COMMAND ${RECORD_PILE} ${WORK}/pile.winnow RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the program was not recorded")
endif()
check(contacts ${WORK}/pile.winnow --frames 0)
file(READ ${WORK}/contacts.json counts)
string(JSON points GET "${counts}" contacts)
open(contacts report)
string(JSON wrong GET "${report}" wrongFrames)
if(points LESS 100 OR NOT wrong EQUAL 0)
  message(FATAL_ERROR "contacts: ${points} points, ${wrong} frames are not what was drawn")
endif()

check(one uniform --objects 1 --partition BoundsNSquared)
if(NOT pointed_at MATCHES "^row0from.*overlaps rowsnone$")
  message(FATAL_ERROR "one: pointing at the object shows '${pointed_at}'")
endif()

# Equal arguments give equal bytes.
draw(again uniform --objects 400 --frame 3 --partition FlatGrid ${questions})
file(SHA256 ${WORK}/grid.html first)
file(SHA256 ${WORK}/again.html second)
if(NOT first STREQUAL second)
  message(FATAL_ERROR "two pages of one picture differ")
endif()

# Checks that the page of a simulation draws its phases.
execute_process(
  COMMAND ${WINNOW} simulate --objects 40 --steps 100 --threads 1 --out ${WORK}/flow.html
  RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE error)
if(error MATCHES "libjs-chart.js")
  message("skipped: ${error}")
  return()
endif()
if(NOT status EQUAL 0)
  message(FATAL_ERROR "winnow simulate: ${error}")
endif()
look(${WORK}/flow.html page)
if(NOT page MATCHES "<canvas[^>]*width=\"[1-9]" OR NOT page MATCHES "handing over poses")
  message(FATAL_ERROR "flow: the phases are not drawn")
endif()
