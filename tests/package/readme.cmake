# The program that README.md shows is, to the letter, the one that the package test builds.
# cmake -DROOT=<source tree> -P readme.cmake
file(READ "${ROOT}/README.md" readme)
file(READ "${ROOT}/tests/package/main.cpp" program)
string(FIND "${program}" "#include" start)
string(SUBSTRING "${program}" ${start} -1 program)
string(FIND "${readme}" "```cpp\n${program}```" found)
if(found EQUAL -1)
  message(FATAL_ERROR "README.md does not show tests/package/main.cpp as it is")
endif()
