/* Uses the rt_plugin_entry of the library it is linked to. */
#include <rt/plugin.h>
RT_EXPORT const rt_module* rt_test_borrowed(void) { return &rt_plugin_entry; }
