// rt: reads the command line, runs the subcommand, and turns whatever escapes it into a message and an exit code.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/interrupt.hpp>
#include <core/plugin_host/fault_report.hpp>

#include <csignal>
#include <new>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace rt::cli {

namespace {

struct Run {
    Console& console;

    int operator()(const HelpText& help) const { return console.result(help.text), int(kExitOk); }
    int operator()(const RenderOptions& o) const { return render(o, console); }
    int operator()(const EncodeOptions& o) const { return encode(o, console); }
    int operator()(const FarmOptions& o) const { return farm(o, console); }
    int operator()(const TaskOptions& o) const { return task(o, console); }
    int operator()(const ViewOptions& o) const { return view(o, console); }
    int operator()(const BenchOptions& o) const { return bench(o, console); }
    int operator()(const CheckOptions& o) const { return check(o, console); }
    int operator()(const InfoOptions& o) const { return info(o, console); }
    int operator()(const SchemaOptions& o) const { return schema(o, console); }
    int operator()(const ConvertOptions& o) const { return convert(o, console); }
    int operator()(const MeshOptions& o) const { return mesh(o, console); }
    int operator()(const CompareOptions& o) const { return compare(o, console); }
    int operator()(const PluginsOptions& o) const { return plugins(o, console); }
    int operator()(const NewOptions& o) const { return newFiles(o, console); }
    int operator()(const ExplainOptions& o) const { return explain(o, console); }
    int operator()(const CompletionOptions& o) const { return completion(o, console); }
    int operator()(const VersionOptions& o) const { return version(o, console); }
};

/// A file opened later must not become stdout or stderr because the caller closed them. Opened the wrong way round, so
/// that using them fails instead of losing what is written.
void holdStandardDescriptors() {
    for (int descriptor = 0; descriptor <= 2; ++descriptor)
        if (::fcntl(descriptor, F_GETFD) < 0)
            ::open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY);
}

/// std::filesystem says so in its own way.
bool lackedMemory(const std::exception& error) {
    const auto* const system = dynamic_cast<const std::system_error*>(&error);
    return dynamic_cast<const std::bad_alloc*>(&error) ||
           (system && system->code() == std::errc::not_enough_memory);
}

int run(int argc, const char* const* argv) {
    CommandLine line;
    for (int i = 1; i < argc;
         ++i) // an error of the command line itself has to be said as asked, too
        if (std::string_view(argv[i]) == "--json-errors") line.common.jsonErrors = true;
    try {
        parseCommandLine(argc, argv, line);
        if (line.common.jsonErrors) plugin_host::reportFaultsAsJson();
        Console console(line.common);
        return std::visit(Run{console}, line.options);
    } catch (const UsageError& error) {
        const std::string help =
            line.command.empty() ? "rt --help" : "rt " + line.command + " --help";
        Console(line.common)
            .fail(line.command, kExitUsage, error.what(),
                  error.hint.empty() ? "see " + help : error.hint);
        return kExitUsage;
    } catch (const StdoutError& error) {
        Console(line.common).fail(line.command, kExitOutput, error.what(), "");
        return kExitOutput;
    } catch (const std::exception& error) {
        if (lackedMemory(error)) {
            Console(line.common).fail(line.command, kExitLimit, "out of memory", "");
            return kExitLimit;
        }
        Console(line.common)
            .fail(line.command, kExitInternal, std::string("internal error: ") + error.what(),
                  "please report it");
        return kExitInternal;
    }
}

} // namespace

} // namespace rt::cli

int main(int argc, char** argv) {
    rt::cli::holdStandardDescriptors();
    std::signal(SIGXFSZ, SIG_IGN); // a full quota is an error of write(), with a message
    rt::cli::handleInterrupts();
    rt::plugin_host::reportFaults();
    const int exitCode = rt::cli::run(argc, argv);
    rt::plugin_host::expectExit();
    return exitCode;
}
