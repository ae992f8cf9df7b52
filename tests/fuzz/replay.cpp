// Runs a fuzz target over files and the files of folders: what stands in for libFuzzer in an ordinary build.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size);

int main(int count, char** arguments) {
    namespace fs = std::filesystem;
    int runs = 0;
    const auto run = [&](const fs::path& path) {
        std::ifstream in(path, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        LLVMFuzzerTestOneInput(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
        ++runs;
    };
    for (int i = 1; i < count; ++i) {
        if (!fs::is_directory(arguments[i]))
            run(arguments[i]);
        else
            for (const auto& entry : fs::directory_iterator(arguments[i])) run(entry.path());
    }
    std::printf("%d inputs\n", runs);
    return runs ? 0 : 1;
}
