# Debian packages, by `cpack -G DEB` in the build folder; scripts/packages does all of it.
# An installation has one component a package, of the same name.
# Nobody has an address so far: whoever hands packages on puts theirs there.
set(MJDIAG_MAINTAINER "The authors of mjdiag <authors@mjdiag.example>" CACHE STRING
    "Whom the packages name as their maintainer: name <address>")
set(components mjdiag mjdiag-video libmjdiag0 libmjdiag-dev mjdiag-data)
if(TARGET mjdiag_mpi)
  list(APPEND components mjdiag-mpi)
endif()
if(TARGET mjdiag_python)
  list(APPEND components python3-mjdiag)
endif()

# What every Debian package has to say of itself.
set(documents ${PROJECT_BINARY_DIR}/packages)
string(TIMESTAMP mjdiag_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(${PROJECT_SOURCE_DIR}/cmake/packages/changelog.in ${documents}/changelog @ONLY)
install(CODE "execute_process(COMMAND gzip -9nkf ${documents}/changelog
                              COMMAND_ERROR_IS_FATAL ANY)" ALL_COMPONENTS)
foreach(component IN LISTS components)
  install(FILES ${documents}/changelog.gz ${PROJECT_SOURCE_DIR}/cmake/packages/copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${component} COMPONENT ${component}
          EXCLUDE_FROM_ALL)
endforeach()
install(PROGRAMS ${PROJECT_SOURCE_DIR}/cmake/packages/demo
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/mjdiag/examples COMPONENT mjdiag
        EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME mjdiag)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # every package has one of its own
set(CPACK_PACKAGE_CONTACT "${MJDIAG_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

# mjdiag_package(<component> SECTION <section> SUMMARY <words> TEXT <words>
#                [DEPENDS <packages...>] [RECOMMENDS <packages...>] [SUGGESTS <packages...>]
#                [CONTROL <files...>] [BINARY | ALL])
# BINARY: the libraries that it is linked to are found out. ALL: the same on every machine.
function(mjdiag_package component)
  cmake_parse_arguments(arg "BINARY;ALL" "SECTION;SUMMARY;TEXT"
                        "DEPENDS;RECOMMENDS;SUGGESTS;CONTROL" ${ARGN})
  string(TOUPPER ${component} id)
  list(JOIN arg_DEPENDS ", " depends)
  list(JOIN arg_RECOMMENDS ", " recommends)
  list(JOIN arg_SUGGESTS ", " suggests)
  set(CPACK_DEBIAN_${id}_PACKAGE_NAME ${component} PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_PACKAGE_SECTION ${arg_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_PACKAGE_RECOMMENDS "${recommends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_PACKAGE_SUGGESTS "${suggests}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_PACKAGE_CONTROL_EXTRA "${arg_CONTROL}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${id}_DESCRIPTION "${arg_SUMMARY}\n${arg_TEXT}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_DESCRIPTION "${arg_SUMMARY}\n${arg_TEXT}" PARENT_SCOPE)
  if(arg_BINARY)
    set(CPACK_DEBIAN_${id}_PACKAGE_SHLIBDEPS ON PARENT_SCOPE)
  endif()
  if(arg_ALL)
    set(CPACK_DEBIAN_${id}_PACKAGE_ARCHITECTURE all PARENT_SCOPE)
  endif()
endfunction()

set(same "(= ${PROJECT_VERSION})")
set(about "mjdiag finds what has worn in a machine that moves while it runs, and what a
MuJoCo model of it gets wrong on measured data.")
# What is only looked for when a report or a picture is made, no linker knows.
set(report libjs-dygraphs)
set(picture libosmesa6 "mjdiag-video ${same}")
mjdiag_package(mjdiag SECTION science BINARY DEPENDS ${report}
  RECOMMENDS "mjdiag-data ${same}" ${picture}
  SUMMARY "fault diagnosis and model discovery for machines - command"
  TEXT "${about}
This package has the command, its manual pages and its completion.")
mjdiag_package(mjdiag-video SECTION science BINARY
  SUMMARY "fault diagnosis and model discovery for machines - clips"
  TEXT "${about}
This package lets the command and the Python module write clips.")
if(TARGET mjdiag_mpi)
  mjdiag_package(mjdiag-mpi SECTION science BINARY DEPENDS "mjdiag ${same}"
    RECOMMENDS openmpi-bin
    SUMMARY "fault diagnosis and model discovery for machines - MPI"
    TEXT "${about}
This package lets the ranks of an MPI job share the runs of a study.")
endif()
mjdiag_package(mjdiag-data SECTION science ALL
  SUMMARY "fault diagnosis and model discovery for machines - models"
  TEXT "${about}
This package has MuJoCo models and setups of a wire bonder, a motion stage, a
voice coil, a servo and an arm, as examples and as a beginning of one's own.")
mjdiag_package(libmjdiag0 SECTION libs BINARY
  CONTROL ${PROJECT_SOURCE_DIR}/cmake/packages/libmjdiag0/triggers
          ${documents}/shlibs
  SUMMARY "control and diagnosis in any MuJoCo program - library"
  TEXT "${about}
This package has the shared library with its interface in C.")
file(WRITE ${documents}/shlibs
     "libmjdiag ${PROJECT_VERSION_MAJOR} libmjdiag0 (>= ${PROJECT_VERSION})\n")
mjdiag_package(libmjdiag-dev SECTION libdevel
  DEPENDS "libmjdiag0 ${same}" libmujoco-dev libeigen3-dev
  # For programs that link the libraries in C++: what Dependencies.cmake asks for.
  RECOMMENDS libmatio-dev coinor-libclp-dev libtbb-dev libopencv-core-dev
             libopencv-ml-dev libopencv-imgproc-dev libpng-dev libhdf5-dev zlib1g-dev
             ${report}
  SUMMARY "control and diagnosis in any MuJoCo program - development"
  TEXT "${about}
This package has the headers, the libraries in C++ and what CMake needs to
find them.")
if(TARGET mjdiag_python)
  # Built for one version of the interpreter.
  set(next ${Python_VERSION_MINOR})
  get_directory_property(minor DIRECTORY ${PROJECT_SOURCE_DIR}/python DEFINITION Python_VERSION_MINOR)
  math(EXPR next "${minor} + 1")
  mjdiag_package(python3-mjdiag SECTION python BINARY
    DEPENDS "python3 (>= 3.${minor})" "python3 (<< 3.${next})" python3-numpy
            ${report}
    RECOMMENDS "mjdiag-data ${same}" ${picture}
    # For frames and plots only, and twice as much to fetch as all the rest.
    SUGGESTS python3-pandas python3-matplotlib
    CONTROL ${PROJECT_SOURCE_DIR}/cmake/packages/python3-mjdiag/postinst
            ${PROJECT_SOURCE_DIR}/cmake/packages/python3-mjdiag/prerm
    SUMMARY "fault diagnosis and model discovery for machines - Python 3"
    TEXT "${about}
This package has the Python module.")
endif()
include(CPack)
