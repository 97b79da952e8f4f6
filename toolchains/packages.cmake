# Debian packages, from what the rooms install:
#
#   rig-controller   component controller    of every build that has rig_controller: a board's, and this PC's
#   rigtwin          component program       the workbench: program, FMU libraries, rigs, manual pages, completion, manual
#   rigtwin-dev      component development   model/ as a library for other programs: find_package(rigtwin)
#   python3-rigtwin  component python        the module of notebooks
#
#   cmake --build build/host --target packages            all of them, in build/host/packages
#   cpack --config build/aarch64/CPackConfig.cmake        a board's
set(components "")
if(TARGET rig_controller)
  list(APPEND components controller)
endif()
if(TARGET rigtwin)
  list(APPEND components program development)
endif()
if(TARGET rigtwin_python)
  list(APPEND components python)
endif()
if(NOT components)
  return()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_NAME rigtwin)
set(CPACK_PACKAGE_CONTACT "the rigtwin project <rigtwin@localhost>")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION electronics)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL "arm")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE armhf)
endif()

set(CPACK_DEBIAN_CONTROLLER_PACKAGE_NAME rig-controller)
set(CPACK_COMPONENT_CONTROLLER_DESCRIPTION "Controller of a quarter-car or component rig, in real time")
set(CPACK_DEBIAN_CONTROLLER_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/firmware/controller/deploy/postinst")
if(TARGET rig_controller)
  get_target_property(gpio_sources hal_linux SOURCES)
  set(gpiod libgpiod3)
  if(gpio_sources MATCHES "gpio_v1")
    set(gpiod libgpiod2)
  endif()
  set(CPACK_DEBIAN_CONTROLLER_PACKAGE_DEPENDS "libc6, libstdc++6, ${gpiod}, libiio0, adduser")
endif()

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME rigtwin)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Digital twin of suspension rigs: simulate, compare, diagnose, stability")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "rig-controller")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME rigtwin-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The model of rigtwin as a C++ library")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, g++")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-rigtwin)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "rigtwin in notebooks: recordings as pandas frames, analyses as objects")

# What rigtwin depends on is read off the program when the package is made: names and versions differ between releases of Debian.
# (CPack's own way looks at every library, and takes the FMU's for another machine for one of this.)
if(TARGET rigtwin)
  set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_BINARY_DIR}/generated/package_dependencies.cmake")
  file(WRITE "${CPACK_PROJECT_CONFIG_FILE}" "set(program \"${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/rigtwin\")\n" [=[
set(folder "${CMAKE_CURRENT_LIST_DIR}/dependencies")
file(WRITE "${folder}/debian/control" "Source: rigtwin\nPackage: rigtwin\nArchitecture: any\n")
execute_process(COMMAND dpkg-shlibdeps -O "${program}" WORKING_DIRECTORY "${folder}" OUTPUT_VARIABLE found ERROR_QUIET
                OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT found MATCHES "shlibs:Depends=(.+)")
  message(FATAL_ERROR "dpkg-shlibdeps cannot tell what ${program} needs: is it built, is dpkg-dev installed?")
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${CMAKE_MATCH_1}")
file(GLOB module "${CMAKE_CURRENT_LIST_DIR}/../python/rigtwin/_core*.so")
if(module)
  string(REGEX REPLACE ".*cpython-3([0-9]+)-.*" "\\1" minor "${module}")
  math(EXPR next "${minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "rigtwin (= ${CPACK_PACKAGE_VERSION}), python3 (>= 3.${minor}), python3 (<< 3.${next}), python3-pandas, ${CMAKE_MATCH_1}")
else()
  list(REMOVE_ITEM CPACK_COMPONENTS_ALL python)  # it was not built
endif()
]=])
  add_custom_target(packages
    COMMAND "${CMAKE_CPACK_COMMAND}" --config "${PROJECT_BINARY_DIR}/CPackConfig.cmake" -B "${PROJECT_BINARY_DIR}/packages"
    DEPENDS rigtwin_documents model COMMENT "Debian packages in ${PROJECT_BINARY_DIR}/packages" VERBATIM)
  foreach(target rigtwin_fmu rigtwin_fmu_aarch64 rigtwin_fmu_win64 rig_controller rigtwin_python)
    if(TARGET ${target})
      add_dependencies(packages ${target})
    endif()
  endforeach()
endif()
include(CPack)
