// One function per subcommand; each returns the exit code.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/cli/console.hpp>

namespace rt::cli {

int render(const RenderOptions& options, Console& console);
int encode(const EncodeOptions& options, Console& console);
int farm(const FarmOptions& options, Console& console);
int task(const TaskOptions& options, Console& console);
int view(const ViewOptions& options, Console& console);
int bench(const BenchOptions& options, Console& console);
int check(const CheckOptions& options, Console& console);
int info(const InfoOptions& options, Console& console);
int schema(const SchemaOptions& options, Console& console);
int convert(const ConvertOptions& options, Console& console);
int mesh(const MeshOptions& options, Console& console);
int compare(const CompareOptions& options, Console& console);
int plugins(const PluginsOptions& options, Console& console);
int newFiles(const NewOptions& options, Console& console);
int explain(const ExplainOptions& options, Console& console);
int completion(const CompletionOptions& options, Console& console);
int version(const VersionOptions& options, Console& console);

} // namespace rt::cli
