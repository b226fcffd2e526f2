# SPDX-License-Identifier: GPL-3.0-or-later
# Python sources stand beside the built program as they will beside the installed one: <prefix>/bin/thalweg looks for
# <prefix>/share/thalweg/NAME. Whoever builds the program alone has them, too.
function(thalweg_scripts name)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  file(GLOB sources CONFIGURE_DEPENDS ${ARGN})
  set(folder ${CMAKE_BINARY_DIR}/share/thalweg/${name})
  set(copies)
  foreach(source IN LISTS sources)
    get_filename_component(file ${source} NAME)
    add_custom_command(OUTPUT ${folder}/${file} DEPENDS ${source}
                       COMMAND ${CMAKE_COMMAND} -E copy ${source} ${folder}/${file} VERBATIM)
    list(APPEND copies ${folder}/${file})
  endforeach()
  add_custom_target(thalweg_${name} ALL DEPENDS ${copies})
  add_dependencies(thalweg thalweg_${name})
  install(FILES ${sources} DESTINATION ${CMAKE_INSTALL_DATADIR}/thalweg/${name})
endfunction()
