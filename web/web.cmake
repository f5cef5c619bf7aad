# The report's front end: npm builds one HTML file, which becomes an array of bytes in a .cpp.
# veridyn_embed_report(OUT_VARIABLE) gives the path of that .cpp.
#
# npm works on a copy in the build tree: several build trees do not disturb each other, and the source tree stays as it
# is. Packages are fetched again only when the lock file changes, the bundle made again only when a source does.
set(VERIDYN_WEB_SOURCE ${CMAKE_CURRENT_LIST_DIR})

function(veridyn_embed_report out)
  find_program(NPM_EXECUTABLE npm)
  find_program(NODE_EXECUTABLE node)
  if(NOT NPM_EXECUTABLE OR NOT NODE_EXECUTABLE)
    message(FATAL_ERROR "The report's front end needs node (18 or newer) and npm; install them or configure with -DVERIDYN_WEB=OFF")
  endif()
  set(copy ${PROJECT_BINARY_DIR}/web)
  set(install_files package.json package-lock.json .npmrc)
  file(GLOB_RECURSE build_files RELATIVE ${VERIDYN_WEB_SOURCE} CONFIGURE_DEPENDS ${VERIDYN_WEB_SOURCE}/src/*)
  list(APPEND build_files report.html tsconfig.json build.mjs)

  set(install_copies)
  foreach(file IN LISTS install_files)
    list(APPEND install_copies ${VERIDYN_WEB_SOURCE}/${file})
  endforeach()
  add_custom_command(
    OUTPUT ${copy}/packages.stamp
    COMMAND ${CMAKE_COMMAND} -E make_directory ${copy}
    COMMAND ${CMAKE_COMMAND} -E copy ${install_copies} ${copy}
    COMMAND ${CMAKE_COMMAND} -E chdir ${copy} ${NPM_EXECUTABLE} ci --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${copy}/packages.stamp
    DEPENDS ${install_copies}
    WORKING_DIRECTORY ${PROJECT_BINARY_DIR}
    COMMENT "Fetching the front end's packages"
    VERBATIM)

  set(sources)
  set(copies)
  foreach(file IN LISTS build_files)
    list(APPEND sources ${VERIDYN_WEB_SOURCE}/${file})
    list(APPEND copies COMMAND ${CMAKE_COMMAND} -E copy ${VERIDYN_WEB_SOURCE}/${file} ${copy}/${file})
  endforeach()
  add_custom_command(
    OUTPUT ${copy}/dist/report.html
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${copy}/src ${copy}/dist
    COMMAND ${CMAKE_COMMAND} -E make_directory ${copy}/src/plots
    ${copies}
    COMMAND ${NPM_EXECUTABLE} run build --silent
    DEPENDS ${copy}/packages.stamp ${sources}
    WORKING_DIRECTORY ${copy}
    COMMENT "Building the report's front end"
    VERBATIM)

  set(generated ${PROJECT_BINARY_DIR}/generated/report_page.cpp)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DINPUT=${copy}/dist/report.html -DOUTPUT=${generated} -P ${VERIDYN_WEB_SOURCE}/embed.cmake
    DEPENDS ${copy}/dist/report.html ${VERIDYN_WEB_SOURCE}/embed.cmake
    COMMENT "Embedding the report's front end"
    VERBATIM)
  set(${out} ${generated} PARENT_SCOPE)
endfunction()
