# rt_add_plugin(NAME SOURCE...): NAME.rtplugin.so, a module that exports rt_plugin_entry and nothing else.
# Needs the target rt::plugin (the SDK's headers).
set(RT_PLUGIN_EXPORTS ${CMAKE_CURRENT_LIST_DIR}/rt_plugin.version)

function(rt_add_plugin name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE rt::plugin)
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX ".rtplugin.so"
                        C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_link_options(${name} PRIVATE -Wl,--version-script=${RT_PLUGIN_EXPORTS})
  if(NOT RT_FUZZ AND NOT RT_SANITIZE) # clang's sanitizers leave their symbols to the program
    target_link_options(${name} PRIVATE -Wl,-z,defs)
  endif()
endfunction()
