#include <core/plugin_host/stamp.hpp>

#include <rt/plugin.h>

#include <elf.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

namespace rt::plugin_host {
namespace {

#if defined(__x86_64__)
constexpr Elf64_Half kMachine = EM_X86_64;
constexpr const char* kMachineName = "x86-64";
#elif defined(__aarch64__)
constexpr Elf64_Half kMachine = EM_AARCH64;
constexpr const char* kMachineName = "AArch64";
#else
#error "name the ELF machine of this processor"
#endif

constexpr std::string_view kEntry = "rt_plugin_entry";

/// Why a file is no module. Thrown inside this file only.
struct Refused {
    std::string why;
};

/// An ELF file of this machine. Every read is held against the file's size.
class ElfFile {
public:
    explicit ElfFile(int fd) : fd_(fd) {
        struct stat status {};
        if (fstat(fd, &status) != 0) throw Refused{"it cannot be read"};
        size_ = static_cast<std::uint64_t>(status.st_size);
        if (size_ < sizeof(Elf64_Ehdr)) throw Refused{"it is not an ELF file"};
        header_ = read<Elf64_Ehdr>(0);
        if (std::memcmp(header_.e_ident, ELFMAG, SELFMAG) != 0)
            throw Refused{"it is not an ELF file"};
        if (header_.e_ident[EI_CLASS] != ELFCLASS64 || header_.e_ident[EI_DATA] != ELFDATA2LSB ||
            header_.e_machine != kMachine)
            throw Refused{std::string("it is not built for this machine (64-bit ") + kMachineName +
                          ")"};
        if (header_.e_type != ET_DYN) throw Refused{"it is not a shared library"};
        if (header_.e_phentsize != sizeof(Elf64_Phdr) || header_.e_phnum == 0)
            throw Refused{"its ELF program headers are damaged"};
        if (header_.e_shnum != 0 &&
            !holds(header_.e_shoff, std::uint64_t{header_.e_shnum} * header_.e_shentsize))
            throw Refused{"it is truncated"};
        for (std::uint64_t i = 0; i < header_.e_phnum; ++i) {
            segments_.push_back(read<Elf64_Phdr>(header_.e_phoff + i * sizeof(Elf64_Phdr)));
            const Elf64_Phdr& segment = segments_.back();
            if ((segment.p_type == PT_LOAD || segment.p_type == PT_DYNAMIC) &&
                !holds(segment.p_offset, segment.p_filesz))
                throw Refused{"it is truncated"};
        }
    }

    const std::vector<Elf64_Phdr>& segments() const { return segments_; }

    template <class T> T read(std::uint64_t offset) const {
        T value;
        bytes(offset, &value, sizeof value);
        return value;
    }

    void bytes(std::uint64_t offset, void* to, std::uint64_t count) const {
        if (!holds(offset, count)) throw Refused{"it is truncated"};
        char* next = static_cast<char*>(to);
        while (count != 0) {
            const ssize_t got = pread(fd_, next, count, static_cast<off_t>(offset));
            if (got <= 0) throw Refused{"it cannot be read"};
            next += got, offset += static_cast<std::uint64_t>(got),
                count -= static_cast<std::uint64_t>(got);
        }
    }

    /// Where `count` bytes at an address of the loaded module lie in the file.
    std::uint64_t offsetOf(std::uint64_t address, std::uint64_t count) const {
        for (const Elf64_Phdr& s : segments_)
            if (s.p_type == PT_LOAD && address >= s.p_vaddr && count <= s.p_filesz &&
                address - s.p_vaddr <= s.p_filesz - count)
                return s.p_offset + (address - s.p_vaddr);
        throw Refused{"its dynamic section is damaged"};
    }

private:
    bool holds(std::uint64_t offset, std::uint64_t count) const {
        return offset <= size_ && count <= size_ - offset;
    }

    int fd_;
    std::uint64_t size_ = 0;
    Elf64_Ehdr header_{};
    std::vector<Elf64_Phdr> segments_;
};

/// The part of the dynamic section that names symbols. 0: absent.
struct Dynamic {
    std::uint64_t symbols = 0, strings = 0, stringsSize = 0, hash = 0, gnuHash = 0;
};

Dynamic readDynamic(const ElfFile& file) {
    Dynamic dynamic;
    for (const Elf64_Phdr& segment : file.segments()) {
        if (segment.p_type != PT_DYNAMIC) continue;
        for (std::uint64_t at = 0; at + sizeof(Elf64_Dyn) <= segment.p_filesz;
             at += sizeof(Elf64_Dyn)) {
            const auto entry = file.read<Elf64_Dyn>(segment.p_offset + at);
            switch (entry.d_tag) {
            case DT_SYMTAB:
                dynamic.symbols = entry.d_un.d_ptr;
                break;
            case DT_STRTAB:
                dynamic.strings = entry.d_un.d_ptr;
                break;
            case DT_STRSZ:
                dynamic.stringsSize = entry.d_un.d_val;
                break;
            case DT_HASH:
                dynamic.hash = entry.d_un.d_ptr;
                break;
            case DT_GNU_HASH:
                dynamic.gnuHash = entry.d_un.d_ptr;
                break;
            case DT_NULL:
                return dynamic;
            default:
                break;
            }
        }
    }
    return dynamic;
}

/// The number of dynamic symbols stands in DT_HASH, or follows from the last chain of DT_GNU_HASH.
std::uint64_t symbolCount(const ElfFile& file, const Dynamic& dynamic) {
    const auto word = [&](std::uint64_t address) {
        return file.read<std::uint32_t>(file.offsetOf(address, sizeof(std::uint32_t)));
    };
    if (dynamic.hash != 0) return word(dynamic.hash + 4);
    if (dynamic.gnuHash == 0) return 0;
    const std::uint64_t buckets = word(dynamic.gnuHash), firstHashed = word(dynamic.gnuHash + 4),
                        bloomWords = word(dynamic.gnuHash + 8);
    const std::uint64_t bucketsAt = dynamic.gnuHash + 16 + 8 * bloomWords,
                        chainsAt = bucketsAt + 4 * buckets;
    file.offsetOf(bucketsAt, 4 * buckets);
    std::uint64_t last = 0;
    for (std::uint64_t i = 0; i < buckets; ++i)
        last = std::max<std::uint64_t>(last, word(bucketsAt + 4 * i));
    if (last < firstHashed) return firstHashed; // nothing is exported
    while ((word(chainsAt + 4 * (last - firstHashed)) & 1u) == 0) ++last;
    return last + 1;
}

std::optional<Elf64_Sym> findEntry(const ElfFile& file) {
    const Dynamic dynamic = readDynamic(file);
    if (dynamic.symbols == 0 || dynamic.strings == 0) return {};
    const std::uint64_t count = symbolCount(file, dynamic);
    for (std::uint64_t i = 1; i < count; ++i) {
        const auto symbol = file.read<Elf64_Sym>(
            file.offsetOf(dynamic.symbols + i * sizeof(Elf64_Sym), sizeof(Elf64_Sym)));
        if (symbol.st_name >= dynamic.stringsSize ||
            dynamic.stringsSize - symbol.st_name <= kEntry.size())
            continue;
        char name[kEntry.size() + 1];
        file.bytes(file.offsetOf(dynamic.strings + symbol.st_name, sizeof name), name, sizeof name);
        if (std::string_view(name, sizeof name) ==
            std::string_view(kEntry.data(), kEntry.size() + 1))
            return symbol;
    }
    return {};
}

std::string version(std::uint32_t major, std::uint32_t minor) {
    return std::to_string(major) + "." + std::to_string(minor);
}

} // namespace

std::variant<Stamp, std::string> readStamp(int fd) {
    try {
        const ElfFile file(fd);
        const auto symbol = findEntry(file);
        if (!symbol) return "it does not export rt_plugin_entry";
        if (symbol->st_shndx == SHN_UNDEF)
            return "it borrows rt_plugin_entry from another library instead of defining it";
        if (ELF64_ST_TYPE(symbol->st_info) != STT_OBJECT || symbol->st_size < sizeof(Stamp))
            return "its rt_plugin_entry is not an rt_module";
        return file.read<Stamp>(file.offsetOf(symbol->st_value, sizeof(Stamp)));
    } catch (const Refused& refused) {
        return refused.why;
    }
}

std::string whyIncompatible(const Stamp& stamp) {
    constexpr char magic[8] = RT_ABI_MAGIC;
    if (std::memcmp(stamp.magic.data(), magic, sizeof magic) != 0)
        return "its rt_plugin_entry is not an rt_module";
    const std::string host = version(RT_ABI_MAJOR, RT_ABI_MINOR),
                      theirs = version(stamp.abiMajor, stamp.abiMinor);
    if (stamp.abiMajor != RT_ABI_MAJOR)
        return "it was built for plugin ABI " + theirs + " and this rt speaks " + host +
               "; rebuild it against this rt";
    if (stamp.abiMinor > RT_ABI_MINOR)
        return "it was built for plugin ABI " + theirs + " and this rt speaks only " + host +
               "; update rt, or rebuild it against this rt";
    if (stamp.layout != RT_ABI_LAYOUT)
        return "its structs are laid out differently (a modified rt/plugin.h, or packing flags); "
               "rebuild it against this rt";
    // rt_module as of 1.0 ends with `loader`.
    if (stamp.structSize < offsetof(rt_module, loader) + sizeof(void*))
        return "its rt_plugin_entry is not an rt_module";
    return {};
}

} // namespace rt::plugin_host
