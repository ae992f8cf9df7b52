# What a third party needs: headers, find_package(rt), rt_add_plugin; and the shipped plugins beside `rt`. The build tree is a
# prefix of its own, so that `rt new` works before anything is installed.
include(CMakePackageConfigHelpers)

file(STRINGS ${CMAKE_SOURCE_DIR}/core/include/rt/plugin.h abi_lines REGEX "^#define RT_ABI_(MAJOR|MINOR) ")
string(REGEX REPLACE ".*MAJOR ([0-9]+)u.*MINOR ([0-9]+)u.*" "\\1.\\2" RT_ABI "${abi_lines}")

# Minors are compatible upward: a plugin that asks for 1.0 builds with the headers of 1.3.
function(rt_write_package include folder)
  set(RT_SDK_INCLUDE ${include})
  configure_package_config_file(${CMAKE_CURRENT_SOURCE_DIR}/package/rtConfig.cmake.in ${folder}/rtConfig.cmake
    INSTALL_DESTINATION lib/cmake/rt PATH_VARS RT_SDK_INCLUDE NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  write_basic_package_version_file(${folder}/rtConfigVersion.cmake VERSION ${RT_ABI} COMPATIBILITY SameMajorVersion
    ARCH_INDEPENDENT)
  file(COPY package/rt_add_plugin.cmake package/rt_plugin.version DESTINATION ${folder})
endfunction()
rt_write_package(${CMAKE_SOURCE_DIR}/core/include ${CMAKE_BINARY_DIR}/lib/cmake/rt)
rt_write_package(include ${CMAKE_CURRENT_BINARY_DIR}/package)

install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/package/ DESTINATION lib/cmake/rt)
install(FILES ${CMAKE_SOURCE_DIR}/core/include/rt/plugin.h ${CMAKE_SOURCE_DIR}/core/include/rt/plugin.hpp
        DESTINATION include/rt)

# The program looks for plugins in <its folder>/../lib/rt/plugins.
foreach(folder . loaders)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL MODULE_LIBRARY)
      install(TARGETS ${target} LIBRARY DESTINATION lib/rt/plugins)
    endif()
  endforeach()
endforeach()
