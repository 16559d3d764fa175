# Install rules: the library, public headers, the licence, and the files for find_package(winnow)
# and pkg-config.

include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME library)

# Users of the archives link TBB themselves; a shared library is linked to it.
set(winnow_requires "")
if(NOT WINNOW_SHARED AND WINNOW_TBB)
  list(APPEND winnow_requires tbb)
endif()
list(JOIN winnow_requires ", " winnow_pc_requires)
if(WINNOW_SHARED)
  set(winnow_targets winnow)
  set(winnow_pc_libs -lwinnow)
  set(winnow_pc_flags -DWINNOW_SHARED=1)
else()
  set(winnow_targets winnow_core winnow_simd winnow_partitions winnow_pipeline winnow)
  set(winnow_pc_libs "-lwinnow_pipeline -lwinnow_partitions -lwinnow_simd -lwinnow_core")
  set(winnow_pc_flags "")
  if(WINNOW_C)
    list(APPEND winnow_targets winnow_c_static)
  endif()
endif()
install(TARGETS ${winnow_targets} EXPORT winnow-targets
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})

foreach(header ${WINNOW_PUBLIC_HEADERS})
  winnow_public_name(public ${header})
  get_filename_component(room winnow/${public} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${room})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
# Pretty printers of public types for debuggers.
install(FILES ${CMAKE_CURRENT_LIST_DIR}/debuggers/winnow_gdb.py
              ${CMAKE_CURRENT_LIST_DIR}/debuggers/winnow.natvis
        DESTINATION ${CMAKE_INSTALL_DATADIR}/winnow)

set(winnow_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/winnow)
set(WINNOW_WITH_CLUSTER OFF)
if(TARGET winnow_cluster)
  set(WINNOW_WITH_CLUSTER ON)
endif()
install(EXPORT winnow-targets NAMESPACE winnow:: DESTINATION ${winnow_package_dir})
if(TARGET winnow_c)
  # A separate export set: programs in C load only this one, and need no dependency of the C++
  # library.
  install(TARGETS winnow_c EXPORT winnow-c-targets
          RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT winnow-c-targets NAMESPACE winnow:: DESTINATION ${winnow_package_dir})
endif()
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/winnow-config.cmake.in ${PROJECT_BINARY_DIR}/winnow-config.cmake
  INSTALL_DESTINATION ${winnow_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/winnow-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/winnow-config.cmake
              ${PROJECT_BINARY_DIR}/winnow-config-version.cmake
        DESTINATION ${winnow_package_dir})
if(TARGET winnow_cluster)
  install(TARGETS winnow_cluster EXPORT winnow-cluster-targets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT winnow-cluster-targets NAMESPACE winnow:: DESTINATION ${winnow_package_dir})
endif()

file(RELATIVE_PATH winnow_pc_to_prefix
     ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
# -isystem hides warnings in winnow's headers from its users. /usr/include must not be given as a
# system folder again, because #include_next of the standard library would then fail. The prefix is
# known only at installation.
set(winnow_pc_include "@winnow_pc_include@")
set(winnow_pcs winnow)
if(WINNOW_C)
  list(APPEND winnow_pcs winnow-c)
endif()
foreach(pc ${winnow_pcs})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${pc}.pc.in ${PROJECT_BINARY_DIR}/${pc}.pc.in @ONLY)
  install(CODE "
    set(winnow_pc_include \"-isystem \\\${includedir}\")
    if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
      set(winnow_pc_include \"-I\\\${includedir}\")
    endif()
    configure_file([[${PROJECT_BINARY_DIR}/${pc}.pc.in]] [[${PROJECT_BINARY_DIR}/${pc}.pc]] @ONLY)")
  install(FILES ${PROJECT_BINARY_DIR}/${pc}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()
