#include <formats/yaml_reader.hpp>

#include <core/scene/display_text.hpp>
#include <core/scene/input_file.hpp>
#include <core/scene/source.hpp>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <new>
#include <sstream>
#include <unordered_map>

namespace rt::formats {
namespace {

using scene::Code;
using scene::Diagnostics;
using scene::Location;
using scene::Node;
using scene::quoted;

constexpr Code kSyntax{350}, kDuplicateKey{351}, kUnclosed{352}, kTab{353}, kSecondDocument{354},
    kEncoding{355}, kEmpty{356}, kUnknownAnchor{357}, kCycle{358}, kBadKey{359}, kBadMerge{360},
    kTag{361};
constexpr Code kTooDeep{711}, kTooManyNodes{712}, kNoMemory{703};

constexpr const char* kToAllowMore = "--limit-file allows more";

/// Ends the parse after its error has been reported.
struct Abandoned {};

std::string plural(std::size_t n, std::string_view noun) {
    return std::to_string(n) + " " + std::string(noun) + (n == 1 ? "" : "s");
}

std::uint64_t mostBytes(const scene::Limits& limits) {
    return limits.fileBytes != 0 ? limits.fileBytes : scene::kMaxSceneBytes;
}

/// Builds nodes from yaml-cpp's events. Keys of a map arrive as nodes that alternate with its
/// values.
class TreeBuilder final : public YAML::EventHandler {
public:
    TreeBuilder(std::shared_ptr<const scene::Source> source, std::string_view text,
                Diagnostics& diagnostics, const scene::Limits& limits)
        : source_(std::move(source)), text_(text), diagnostics_(diagnostics), limits_(limits) {}

    std::optional<Node> root;

    /// The innermost '[' or '{' that is still open.
    const Node* openFlow() const {
        const auto found = std::find_if(open_.rbegin(), open_.rend(),
                                        [](const Open& open) { return open.node.flow; });
        return found == open_.rend() ? nullptr : &found->node;
    }

    Location at(const YAML::Mark& mark) const {
        return {source_, static_cast<std::uint32_t>(mark.line + 1),
                static_cast<std::uint32_t>(mark.column + 1)};
    }

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (!root) return;
        const bool unmarked =
            root->location.column > 1 && !text_.substr(offsetOf(mark)).starts_with("---");
        fail(kSecondDocument, at(mark),
             unmarked ? "this line is indented less than the first line, so it cannot belong to it"
                      : "a second document starts here; a scene is one document");
    }
    void OnDocumentEnd() override {}

    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        Node node;
        const std::string_view here = text_.substr(std::min(offsetOf(mark), text_.size()));
        const bool written =
            here.starts_with('~') || here.starts_with('n') || here.starts_with('N');
        // Where nothing is written the mark is that of the next token: the key or list is the
        // better place.
        if (written || open_.empty())
            node.location = at(mark);
        else
            node.location =
                open_.back().key ? open_.back().key->location : open_.back().node.location;
        add(std::move(node), anchor);
    }

    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        refuseTag(mark, tag);
        Node node;
        node.kind = Node::Kind::scalar;
        node.quoted = tag == "!"; // yaml-cpp's mark for quoted and block scalars
        node.location = at(mark);
        node.text = value;
        if (node.quoted) requireClosingQuote(mark);
        add(std::move(node), anchor);
    }

    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto found = anchored_.find(anchor);
        if (found == anchored_.end())
            fail(kCycle, at(mark), "this alias refers to the very node that it stands in");
        count(found->second.nodes, at(mark));
        if (open_.size() + found->second.depth > limits_.nesting) failDepth(at(mark));
        attach(Node(found->second.node), found->second.nodes, found->second.depth);
    }

    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value style) override {
        start(Node::Kind::sequence, mark, tag, anchor, style);
    }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value style) override {
        start(Node::Kind::map, mark, tag, anchor, style);
    }
    void OnSequenceEnd() override { end(); }
    void OnMapEnd() override {
        checkKeys(open_.back());
        end();
    }

    [[noreturn]] void fail(Code code, Location location, std::string message,
                           std::string hint = {}) const {
        diagnostics_.error(code, std::move(location), std::move(message), std::move(hint));
        throw Abandoned{};
    }

    std::size_t offsetOf(const YAML::Mark& mark) const {
        return static_cast<std::size_t>(mark.pos);
    }

private:
    struct Open {
        Node node;
        YAML::anchor_t anchor;
        std::size_t nodes = 1, depth = 1;              // of the subtree so far
        std::optional<Node> key;                       // map: read, its value not yet
        std::vector<std::pair<Location, Node>> merges; // values of '<<' keys
    };
    struct Anchored {
        Node node;
        std::size_t nodes, depth;
    };

    void start(Node::Kind kind, const YAML::Mark& mark, const std::string& tag,
               YAML::anchor_t anchor, YAML::EmitterStyle::value style) {
        refuseTag(mark, tag);
        if (open_.size() >= limits_.nesting) failDepth(at(mark));
        Open open{.node = {}, .anchor = anchor, .key = {}, .merges = {}};
        open.node.kind = kind;
        open.node.flow = style == YAML::EmitterStyle::Flow;
        open.node.location = at(mark);
        count(1, open.node.location);
        open_.push_back(std::move(open));
    }

    void end() {
        Open closed = std::move(open_.back());
        open_.pop_back();
        if (closed.anchor != 0) remember(closed.anchor, closed.node, closed.nodes, closed.depth);
        attach(std::move(closed.node), closed.nodes, closed.depth);
    }

    void add(Node node, YAML::anchor_t anchor) {
        count(1, node.location);
        if (anchor != 0) remember(anchor, node, 1, 0);
        attach(std::move(node), 1, 0);
    }

    void remember(YAML::anchor_t anchor, const Node& node, std::size_t nodes, std::size_t depth) {
        count(nodes, node.location); // the copy is held until the end
        anchored_.insert_or_assign(anchor, Anchored{node, nodes, depth});
    }

    void attach(Node node, std::size_t nodes, std::size_t depth) {
        if (open_.empty()) {
            root = std::move(node);
            return;
        }
        Open& parent = open_.back();
        parent.nodes += nodes;
        parent.depth = std::max(parent.depth, depth + 1);
        if (parent.node.kind == Node::Kind::sequence) {
            parent.node.items.push_back(std::move(node));
        } else if (!parent.key) {
            if (node.kind != Node::Kind::scalar)
                fail(kBadKey, node.location,
                     node.kind == Node::Kind::null ? "a key is missing before this ':'"
                                                   : "a key must be a word, not a list or a map");
            parent.key = std::move(node);
        } else {
            if (parent.key->text == "<<" && !parent.key->quoted)
                parent.merges.emplace_back(parent.key->location, std::move(node));
            else
                parent.node.members.push_back(
                    {parent.key->text, parent.key->location, std::move(node)});
            parent.key.reset();
        }
    }

    /// Duplicates are errors; merge keys give what the map itself does not say, the first merged
    /// map first.
    void checkKeys(Open& map) {
        std::vector<Node::Member>& members = map.node.members;
        std::unordered_map<std::string, Location> seen;
        seen.reserve(members.size());
        for (const Node::Member& member : members) {
            const auto [first, isNew] = seen.emplace(member.key, member.keyLocation);
            if (!isNew)
                diagnostics_.error(kDuplicateKey, member.keyLocation,
                                   "the key " + quoted(member.key) +
                                       " stands twice in this map, first in line " +
                                       std::to_string(first->second.line));
        }
        if (map.merges.size() > 1)
            diagnostics_.error(kDuplicateKey, map.merges[1].first,
                               "the key '<<' stands twice in this map, first in line " +
                                   std::to_string(map.merges[0].first.line) +
                                   "; to merge several maps write '<<: [*a, *b]'");
        for (auto& [place, value] : map.merges) {
            const auto merge = [&, &at = place](Node& from) { // clang 14 captures no bindings
                if (from.kind != Node::Kind::map) {
                    diagnostics_.error(kBadMerge, at,
                                       "'<<' merges a map or a list of maps, such as '<<: *name'");
                    return;
                }
                for (Node::Member& member : from.members)
                    if (seen.emplace(member.key, member.keyLocation).second)
                        members.push_back(std::move(member));
            };
            if (value.kind == Node::Kind::sequence)
                for (Node& item : value.items) merge(item);
            else
                merge(value);
        }
    }

    void refuseTag(const YAML::Mark& mark, const std::string& tag) const {
        if (tag.empty() || tag == "?" || tag == "!") return;
        constexpr std::string_view kStandard = "tag:yaml.org,2002:";
        const std::string shown =
            tag.starts_with(kStandard) ? "!!" + tag.substr(kStandard.size()) : tag;
        fail(kTag, at(mark),
             "tags such as " + quoted(shown) + " are not part of the scene language");
    }

    /// yaml-cpp takes the end of the file for a closing quote.
    void requireClosingQuote(const YAML::Mark& mark) const {
        std::size_t i = offsetOf(mark);
        const auto skipWhile = [&](auto&& belongs) {
            while (i < text_.size() && belongs(text_[i])) ++i;
        };
        const auto isSpace = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
        while (i < text_.size() &&
               (text_[i] == '&' || text_[i] == '!' || text_[i] == '#' || isSpace(text_[i]))) {
            if (isSpace(text_[i]))
                skipWhile(isSpace);
            else if (text_[i] == '#')
                skipWhile([](char c) { return c != '\n'; });
            else
                skipWhile([&](char c) { return !isSpace(c); });
        }
        if (i >= text_.size() || (text_[i] != '"' && text_[i] != '\'')) return; // a block scalar
        const char quote = text_[i];
        for (std::size_t j = i + 1; j < text_.size(); ++j) {
            if (quote == '"' && text_[j] == '\\')
                ++j;
            else if (text_[j] == quote) {
                if (quote == '\'' && j + 1 < text_.size() && text_[j + 1] == '\'')
                    ++j;
                else
                    return;
            }
        }
        fail(kUnclosed, at(mark),
             std::string("the quote ") + quote + " that opens here is never closed");
    }

    void count(std::size_t nodes, const Location& location) {
        visited_ += nodes;
        if (visited_ > limits_.nodes)
            fail(kTooManyNodes, location,
                 "the document has more than " + plural(limits_.nodes, "node") +
                     ", aliases expanded; "
                     "large geometry belongs into a mesh file",
                 "--limit-nodes allows more");
    }

    [[noreturn]] void failDepth(Location location) const {
        fail(kTooDeep, std::move(location),
             "lists and maps are nested deeper than " + std::to_string(limits_.nesting) +
                 " levels here",
             "--limit-nesting allows more");
    }

    std::shared_ptr<const scene::Source> source_;
    std::string_view text_;
    Diagnostics& diagnostics_;
    const scene::Limits limits_;
    std::vector<Open> open_;
    std::unordered_map<YAML::anchor_t, Anchored> anchored_;
    std::size_t visited_ = 0;
};

/// Line and column of a byte of the text.
Location locate(const std::shared_ptr<const scene::Source>& source, std::size_t offset) {
    const std::string_view before = std::string_view(source->text).substr(0, offset);
    const std::size_t lineStart = before.rfind('\n') + 1; // npos + 1 is 0
    return {source, static_cast<std::uint32_t>(std::count(before.begin(), before.end(), '\n') + 1),
            static_cast<std::uint32_t>(offset - lineStart + 1)};
}

bool checkEncoding(const std::shared_ptr<const scene::Source>& source, Diagnostics& diagnostics) {
    const std::string_view text = source->text;
    const auto refuse = [&](std::size_t offset, std::string message) {
        diagnostics.error(kEncoding, locate(source, offset), std::move(message));
        return false;
    };
    const bool utf16 = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
                       (text.size() > 1 && (text[0] == '\0') != (text[1] == '\0'));
    if (utf16) return refuse(0, "the file is UTF-16 or UTF-32; save it as UTF-8");
    if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos)
        return refuse(nul, "a NUL byte stands here; this is no text file");
    if (const std::size_t bad = scene::findInvalidUtf8(text); bad != std::string_view::npos)
        return refuse(bad, "the byte " + quoted(text.substr(bad, 1)) +
                               " is no UTF-8; save the file as UTF-8");
    const std::size_t control =
        std::find_if(text.begin(), text.end(),
                     [](char c) {
                         const auto byte = static_cast<unsigned char>(c);
                         return (byte < 0x20 && c != '\t' && c != '\n' && c != '\r') ||
                                byte == 0x7F;
                     }) -
        text.begin();
    if (control < text.size())
        return refuse(control, "the control character " + quoted(text.substr(control, 1)) +
                                   " cannot stand in a scene");
    for (std::size_t i = text.find('\r'); i != std::string_view::npos; i = text.find('\r', i + 1))
        if (i + 1 >= text.size() || text[i + 1] != '\n')
            return refuse(i, "a carriage return without a line feed; save the file with Unix or "
                             "Windows line ends");
    return true;
}

/// yaml-cpp holds a token for every bracket of a line that is still open, before it tells anybody:
/// 8 MiB of '[' would take 1.3 GB. Quotes and comments are not told apart here, so the limit is
/// far above any limit of nesting.
bool checkOpenBrackets(const std::shared_ptr<const scene::Source>& source,
                       Diagnostics& diagnostics) {
    constexpr std::size_t kMaxOpen = 10'000;
    std::size_t open = 0;
    for (std::size_t i = 0; i < source->text.size(); ++i) {
        const char c = source->text[i];
        if (c == '[' || c == '{')
            ++open;
        else if ((c == ']' || c == '}') && open > 0)
            --open;
        if (open > kMaxOpen) {
            diagnostics.error(kTooDeep, locate(source, i),
                              "more than " + std::to_string(kMaxOpen) + " brackets are open here");
            return false;
        }
    }
    return true;
}

/// The tab that indents line `line`, or the line after `line` - 1 where yaml-cpp noticed too late.
std::optional<Location> indentingTab(const std::shared_ptr<const scene::Source>& source,
                                     std::uint32_t line) {
    std::string_view rest = source->text;
    for (std::uint32_t number = 1; number <= line && !rest.empty(); ++number) {
        const std::string_view current = rest.substr(0, rest.find('\n'));
        const std::size_t first = current.find_first_not_of(' ');
        if (number + 1 >= line && first != std::string_view::npos && current[first] == '\t')
            return Location{source, number, static_cast<std::uint32_t>(first + 1)};
        rest.remove_prefix(std::min(current.size() + 1, rest.size()));
    }
    return std::nullopt;
}

/// yaml-cpp's terse words as a sentence with a place.
void reportSyntax(const YAML::Exception& exception,
                  const std::shared_ptr<const scene::Source>& source, const TreeBuilder& builder,
                  Diagnostics& diagnostics) {
    const std::string& words = exception.msg;
    Location place = exception.mark.is_null() ? Location{source} : builder.at(exception.mark);
    const std::string_view here =
        exception.mark.is_null()
            ? std::string_view{}
            : std::string_view(source->text)
                  .substr(std::min(builder.offsetOf(exception.mark), source->text.size()));
    const auto startsWith = [&](std::string_view prefix) { return words.starts_with(prefix); };

    if (const Node* flow = builder.openFlow()) {
        const std::string_view open = flow->kind == Node::Kind::sequence ? "[" : "{";
        const std::string_view close = flow->kind == Node::Kind::sequence ? "]" : "}";
        if (here.starts_with(close == "]" ? "}" : "]"))
            return diagnostics.error(kUnclosed, place,
                                     "expected '" + std::string(close) + "' for the '" +
                                         std::string(open) + "' of line " +
                                         std::to_string(flow->location.line) + ", but found '" +
                                         here[0] + "'");
        const auto line = scene::lineOf(flow->location);
        const bool hasComment =
            line && line->find(" #", flow->location.column) != std::string_view::npos;
        return diagnostics.error(kUnclosed, flow->location,
                                 "the '" + std::string(open) +
                                     "' that opens here is not closed properly; line " +
                                     std::to_string(place.line) + " has no ',' or '" +
                                     std::string(close) + "' where one must stand",
                                 hasComment ? "' #' starts a comment: put a colour in quotes" : "");
    }
    if (const auto tab = indentingTab(source, place.line); tab && !startsWith("unknown token"))
        return diagnostics.error(kTab, *tab, "a tab indents this line; YAML wants spaces");
    if (startsWith("the referenced anchor"))
        return diagnostics.error(
            kUnknownAnchor, place,
            "no anchor of this name stands above; write '&name' before '*name'");
    if (startsWith("illegal flow end"))
        return diagnostics.error(kSyntax, place,
                                 std::string("this '") + here.substr(0, 1).data()[0] +
                                     "' closes nothing that is open");
    if (startsWith("unknown token") && !here.empty())
        return diagnostics.error(kSyntax, place,
                                 std::string("a value cannot start with ") +
                                     quoted(here.substr(0, 1)) + "; put it in quotes");
    if (startsWith("unknown escape"))
        return diagnostics.error(kSyntax, place,
                                 "unknown escape in a double-quoted text; write '\\\\' for a "
                                 "backslash, or use single quotes");
    if (startsWith("illegal block entry"))
        return diagnostics.error(kSyntax, place,
                                 "a list item cannot start here; put '- ' on a line of its own");
    if (startsWith("illegal map value") || startsWith("illegal map key"))
        return diagnostics.error(
            kSyntax, place,
            "a ':' cannot stand here; check the indentation, or put text that has ': ' in quotes");
    if (startsWith("end of map") || startsWith("end of sequence"))
        return diagnostics.error(kSyntax, place,
                                 "this does not continue the lines above; check the indentation, "
                                 "and the quotes before it");
    diagnostics.error(kSyntax, place, "this is not YAML: " + words);
}

} // namespace

std::optional<Node> parseYaml(std::shared_ptr<const scene::Source> source, Diagnostics& diagnostics,
                              const scene::Limits& limits) {
    const std::size_t errorsBefore = diagnostics.errorCount();
    try {
        if (source->text.size() > mostBytes(limits)) {
            diagnostics.error(scene::kTooLarge, {source}, scene::tooLarge(mostBytes(limits)),
                              kToAllowMore);
            return std::nullopt;
        }
        if (source->text.starts_with("\xEF\xBB\xBF")) { // a byte order mark is no part of line 1
            auto bare = std::make_shared<scene::Source>(*source);
            bare->text.erase(0, 3);
            source = std::move(bare);
        }
        if (!checkEncoding(source, diagnostics) || !checkOpenBrackets(source, diagnostics))
            return std::nullopt;

        std::istringstream stream{source->text};
        TreeBuilder builder{source, source->text, diagnostics, limits};
        try {
            YAML::Parser parser{stream};
            while (parser.HandleNextDocument(builder)) {
            }
        } catch (const YAML::Exception& exception) {
            reportSyntax(exception, source, builder, diagnostics);
        }
        if (diagnostics.errorCount() != errorsBefore) return std::nullopt;
        if (!builder.root || builder.root->kind == Node::Kind::null) {
            diagnostics.error(kEmpty, {source}, "the file is empty: a scene starts with 'rt: 1'");
            return std::nullopt;
        }
        return std::move(builder.root);
    } catch (const Abandoned&) {
        return std::nullopt;
    } catch (const std::bad_alloc&) {
        diagnostics.error(kNoMemory, {}, "out of memory while reading " + quoted(source->path));
        return std::nullopt;
    }
}

std::optional<Node> readYaml(const std::string& path, Diagnostics& diagnostics,
                             const scene::Limits& limits) {
    auto source = scene::readSource(path, mostBytes(limits), diagnostics, {}, kToAllowMore);
    return source ? parseYaml(std::move(source), diagnostics, limits) : std::nullopt;
}

} // namespace rt::formats
