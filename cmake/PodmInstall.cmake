# Installs the programs that mesh, the scripts that they run, the library, and the files that find_package(podm) needs.
# podm-verify and podm-bench install themselves. The wheel contains the components `programs`
# and `pages`.
include(CMakePackageConfigHelpers)

set_target_properties(podm_library PROPERTIES EXPORT_NAME podm)
install(TARGETS podm RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
if(TARGET podm-mpi)
  install(TARGETS podm-mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
set(PODM_SCRIPTS ${PROJECT_SOURCE_DIR}/scripts)
install(PROGRAMS ${PODM_SCRIPTS}/view ${PODM_SCRIPTS}/mesh_report ${PODM_SCRIPTS}/serve
        DESTINATION ${CMAKE_INSTALL_DATADIR}/podm COMPONENT programs)
install(DIRECTORY ${PODM_SCRIPTS}/views ${PODM_SCRIPTS}/report_page ${PODM_SCRIPTS}/serve_page
                  ${PODM_SCRIPTS}/figures
        DESTINATION ${CMAKE_INSTALL_DATADIR}/podm COMPONENT programs PATTERN __pycache__ EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(TARGETS podm_library podm_mesher podm_refine podm_workers podm_optimize podm_octree podm_delaunay podm_lines podm_sizing podm_topology podm_values podm_smoothing podm_isosurface podm_label_image podm_phantoms
                podm_image_io podm_io
                podm_files podm_geometry podm_runtime podm_toml podm_flags
        EXPORT podmTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/mesher/include/podm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

set(PODM_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/podm)
install(EXPORT podmTargets NAMESPACE podm:: DESTINATION ${PODM_CMAKE_DIR})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/podmConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/podmConfig.cmake INSTALL_DESTINATION ${PODM_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/podmConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/podmConfig.cmake ${PROJECT_BINARY_DIR}/podmConfigVersion.cmake
        DESTINATION ${PODM_CMAKE_DIR})
