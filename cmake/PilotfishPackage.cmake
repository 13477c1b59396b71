# The system's side: units, man pages, the configuration in /etc, and the Debian package of it all (scripts/package).
# Off by default: the units name /usr/bin, so they fit a system package and not an installation somewhere else.
option(PILOTFISH_SYSTEM "Install units, man pages and /etc/pilotfish, and make a Debian package (CPack)" OFF)
if(NOT PILOTFISH_SYSTEM)
  return()
endif()
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  message(FATAL_ERROR "PILOTFISH_SYSTEM needs -D CMAKE_INSTALL_PREFIX=/usr: the units start programs in /usr/bin")
endif()
set(packaging ${PROJECT_SOURCE_DIR}/packaging)
set(package_build ${CMAKE_BINARY_DIR}/packaging)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/data/config/coordinator.yaml)
set(system_programs pilotfish-coordinator pilotfish-sim)
set(units pilotfish-lcm-route.service pilotfish-coordinator@.service)
if(TARGET pilotfish-base)
  list(APPEND system_programs pilotfish-base)
  list(APPEND units pilotfish-base@.service)
endif()

# --- units and the user they run as ----------------------------------------------------------------------------------
list(TRANSFORM units PREPEND ${packaging}/systemd/)
install(FILES ${units} DESTINATION lib/systemd/system)
install(FILES ${packaging}/systemd/pilotfish.sysusers.conf DESTINATION lib/sysusers.d RENAME pilotfish.conf)
install(FILES ${packaging}/nftables/pilotfish.nft DESTINATION ${CMAKE_INSTALL_DATADIR}/pilotfish/nftables)

# --- /etc/pilotfish: the shipped configurations, with the paths of the shipped data, and told to stop -------------------
# An installed robot must not drive off at boot because somebody enabled a service: run is false until it is wanted.
set(data_in_place ${CMAKE_INSTALL_FULL_DATADIR}/pilotfish/data)
file(READ ${PROJECT_SOURCE_DIR}/data/config/coordinator.yaml text)
string(REPLACE "../" "${data_in_place}/" text "${text}")
string(REPLACE "\nsource: lcm " "\nsource: camera:0 " text "${text}")
string(REPLACE "\nsetpoint:\n" "\nsetpoint:\n  run: false          # looks, and stands still; true: drives when it sees its leader\n"
       text "${text}")
if(NOT text MATCHES "\n  run: false " OR NOT text MATCHES "\nsource: camera:0 ")
  message(FATAL_ERROR "data/config/coordinator.yaml has changed: /etc/pilotfish/robot1.yaml would not stand still")
endif()
file(WRITE ${package_build}/robot1.yaml "${text}")
set(etc_files ${package_build}/robot1.yaml)
if(EXISTS ${PROJECT_SOURCE_DIR}/data/config/base.yaml)
  file(READ ${PROJECT_SOURCE_DIR}/data/config/base.yaml text)
  string(REPLACE "../" "${data_in_place}/" text "${text}")
  file(WRITE ${package_build}/robot1-base.yaml "${text}")
  list(APPEND etc_files ${package_build}/robot1-base.yaml)
endif()
install(FILES ${etc_files} DESTINATION /etc/pilotfish)

# --- man pages: what --help says, with the sections of packaging/man/*.h2m around it -----------------------------------
find_program(HELP2MAN help2man REQUIRED)
foreach(program ${system_programs} pilotfish-spy)
  set(page ${package_build}/${program}.1)
  set(binary ${CMAKE_BINARY_DIR}/apps/${program})
  set(sections ${packaging}/man/common.h2m ${packaging}/man/${program}.h2m)
  add_custom_command(OUTPUT ${page}.gz
    COMMAND ${packaging}/man/make_page ${HELP2MAN} ${binary} ${page} ${sections}
    COMMAND gzip -9nf ${page}
    DEPENDS ${binary} ${sections} ${packaging}/man/make_page VERBATIM)
  list(APPEND compressed ${page}.gz)
  install(FILES ${page}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endforeach()

# --- completion of the programs' options ---------------------------------------------------------------------------------
foreach(program ${system_programs} pilotfish-spy)
  install(FILES ${packaging}/completion/pilotfish-programs.bash
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ${program})
endforeach()
install(FILES ${packaging}/completion/_pilotfish-programs DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)

# --- documents --------------------------------------------------------------------------------------------------------
set(CPACK_PACKAGE_CONTACT "Pilotfish developers <pilotfish@example.org>")
string(TIMESTAMP today "%a, %d %b %Y 00:00:00 +0000" UTC)  # of $SOURCE_DATE_EPOCH, if that is set
file(WRITE ${package_build}/changelog "pilotfish (${PROJECT_VERSION}) unstable; urgency=medium\n\n"
     "  * See CHANGELOG.md.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${today}\n")
add_custom_command(OUTPUT ${package_build}/changelog.gz COMMAND gzip -9nfk ${package_build}/changelog
  DEPENDS ${package_build}/changelog VERBATIM)
add_custom_target(pilotfish_system_files ALL DEPENDS ${compressed} ${package_build}/changelog.gz)
file(GLOB guides ${PROJECT_SOURCE_DIR}/docs/*.md)
install(FILES ${guides} ${package_build}/changelog.gz ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${packaging}/debian/copyright
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pilotfish)

# --- the Debian package -------------------------------------------------------------------------------------------------
set(conffiles)
foreach(file ${etc_files})
  get_filename_component(name ${file} NAME)
  string(APPEND conffiles "/etc/pilotfish/${name}\n")
endforeach()
file(WRITE ${package_build}/conffiles "${conffiles}")
set(CPACK_GENERATOR DEB)
set(CPACK_INSTALL_CMAKE_PROJECTS "${CMAKE_BINARY_DIR};${PROJECT_NAME};Unspecified;/")  # never the Python package
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "follows another robot by sight alone")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "A coordinator robot looks at AprilTags on a leader, measures distance
and bearing to it, and drives so that both take the values asked for:
the onboard program, a simulator, a viewer of the LCM bus, and services
for systemd.")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "iproute2, systemd | systemd-standalone-sysusers | systemd-sysusers")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "default-jre, liblcm-java, libjchart2d-java, liblcm-bin, nftables")  # -spy; the rule
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${package_build}/conffiles ${packaging}/debian/postinst ${packaging}/debian/prerm
                                       ${packaging}/debian/postrm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
