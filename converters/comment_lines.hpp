// Comments of a legacy file on their way to the place in the new one where they belong.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rt::converters {

/// The text of a comment as YAML may hold it: outer blanks cut, control characters escaped.
std::string commentText(std::string_view text);

/// Lines that wait for the next node of a section, by the section's key; "" is the document itself.
class HeldComments {
public:
    void hold(std::string_view section, std::string line) {
        lines_[std::string(section)].push_back(std::move(line));
    }
    /// Appends to `lines` what is held for `section`, which then holds nothing.
    void moveTo(std::vector<std::string>& lines, std::string_view section);
    const std::map<std::string, std::vector<std::string>>& all() const { return lines_; }

private:
    std::map<std::string, std::vector<std::string>> lines_;
};

} // namespace rt::converters
