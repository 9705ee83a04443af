# podm_manual(PROGRAMS...): makes their manual pages and shell completions in share/ of the build folder from their
# --help output, and installs them.
function(podm_manual)
  find_program(PODM_SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH REQUIRED)
  set(share ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_DATADIR})
  set(maker ${PROJECT_SOURCE_DIR}/scripts/make_manual)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/scripts/manual/*.py)
  set(pages ${ARGN})
  list(TRANSFORM pages PREPEND ${share}/man/man1/)
  list(TRANSFORM pages APPEND .1)
  set(completions ${ARGN})
  list(TRANSFORM completions PREPEND ${share}/bash-completion/completions/)
  set(programs ${ARGN})
  list(TRANSFORM programs REPLACE "(.+)" "$<TARGET_FILE:\\1>")
  add_custom_command(OUTPUT ${pages} ${completions}
                     COMMAND ${PODM_SYSTEM_PYTHON} -B ${maker} --output ${share} ${programs}
                     DEPENDS ${ARGN} ${maker} ${sources} VERBATIM COMMENT "Manual pages and shell completions")
  add_custom_target(manual ALL DEPENDS ${pages} ${completions})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT pages)
  install(FILES ${completions} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT pages)
endfunction()
