# Installs the modules as a library: headers, libraries, the CMake package and the .pc files. In a component of its own
# (`development`), so that the Debian package of the programs does not carry it.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pilotfish)
set(package_build ${PROJECT_BINARY_DIR}/package)
install(FILES include/pilotfish/api.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pilotfish COMPONENT development)

# What a user of a module must find: a static library leaves its private needs to whoever links it.
function(pilotfish_install_module module)
  foreach(kind IN ITEMS MODULES PUBLIC PRIVATE)
    get_property(${kind} GLOBAL PROPERTY pilotfish_${module}_${kind})
  endforeach()
  get_target_property(type pilotfish_${module} TYPE)
  set(dependencies ${PUBLIC})
  if(type STREQUAL "STATIC_LIBRARY")
    list(APPEND dependencies ${PRIVATE})
  endif()
  file(WRITE ${package_build}/pilotfish-${module}-needs.cmake
       "set(pilotfish_modules_below_${module} ${MODULES})\nset(pilotfish_needs_${module} ${dependencies})\n")

  set(postfix)
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    set(postfix ${pilotfish_debug_postfix})
  endif()
  set(requires)
  set(threads)
  foreach(below IN LISTS MODULES)
    list(APPEND requires "pilotfish-${below} = ${PROJECT_VERSION}")
  endforeach()
  foreach(name IN LISTS dependencies)
    if(name STREQUAL "threads")
      set(threads " -pthread")
    else()
      list(APPEND requires ${pilotfish_pc_${name}})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES requires)
  list(JOIN requires ", " requires)
  file(WRITE ${package_build}/pilotfish-${module}.pc
       "prefix=\${pcfiledir}/${pc_to_prefix}\nlibdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}\nincludedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}\n\n"
       "Name: pilotfish-${module}\nDescription: ${PROJECT_DESCRIPTION}: module ${module}\nVersion: ${PROJECT_VERSION}\n"
       "Requires: ${requires}\nLibs: -L\${libdir} -lpilotfish_${module}${postfix}${threads}\nCflags: -I\${includedir}\n")

  install(TARGETS pilotfish_${module} EXPORT pilotfish-${module}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT pilotfish-${module} NAMESPACE pilotfish:: FILE pilotfish-${module}-targets.cmake
          DESTINATION ${package_dir} COMPONENT development)
  install(DIRECTORY include/pilotfish/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pilotfish COMPONENT development)
  install(FILES ${package_build}/pilotfish-${module}-needs.cmake DESTINATION ${package_dir} COMPONENT development)
  install(FILES ${package_build}/pilotfish-${module}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
          COMPONENT development)
endfunction()

file(RELATIVE_PATH pc_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
foreach(module IN LISTS PILOTFISH_MODULES)
  pilotfish_install_module(${module})
endforeach()
configure_package_config_file(cmake/pilotfishConfig.cmake.in ${package_build}/pilotfishConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${package_build}/pilotfishConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${package_build}/pilotfishConfig.cmake ${package_build}/pilotfishConfigVersion.cmake
              cmake/PilotfishDependencies.cmake DESTINATION ${package_dir} COMPONENT development)
if("bus" IN_LIST PILOTFISH_MODULES)  # for whoever makes types in another language from them
  install(DIRECTORY lcmtypes DESTINATION ${CMAKE_INSTALL_DATADIR}/pilotfish COMPONENT development)
endif()
