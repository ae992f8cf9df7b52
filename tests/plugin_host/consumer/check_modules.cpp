// check_modules FOLDER NAME...: opens and checks the modules, for the test of the consumer's project.
#include <core/plugin_host/check.hpp>

#include <cstdio>

int main(int count, char** arguments) {
    rt::plugin_host::Catalog catalog({arguments[1]});
    int faults = 0;
    for (int i = 2; i < count; ++i)
        for (const std::string& fault :
             rt::plugin_host::checkModule(catalog, arguments[i]).faults) {
            std::fprintf(stderr, "%s: %s\n", arguments[i], fault.c_str());
            ++faults;
        }
    return faults == 0 ? 0 : 1;
}
