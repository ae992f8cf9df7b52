#include <core/scene/map_reader.hpp>

#include <core/scene/codes.hpp>

#include <algorithm>
#include <stdexcept>

namespace rt::scene {

namespace {

/// "center, radius and material".
std::string enumerate(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i)
        text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
    return text;
}

Value coreDefault(const rt_param& row) {
    Parsed<Value> parsed = parseFallback(row);
    if (const auto* fault = std::get_if<Fault>(&parsed))
        throw std::logic_error(std::string("the default of '") + row.name + "' " + fault->clause);
    return std::get<Value>(std::move(parsed));
}

} // namespace

void applyDefaults(std::span<const Field> fields, void* section) {
    for (const Field& field : fields) {
        if (isRequired(field) || *field.row.fallback == '\0') continue;
        if (field.form == Form::section)
            applyDefaults(field.fields, section);
        else if (field.assign)
            field.assign(section, coreDefault(field.row));
    }
}

MapReader::MapReader(const Node& map, Location place, std::string subject,
                     const TextureNames& textures, Diagnostics& diagnostics)
    : place_(std::move(place)), subject_(std::move(subject)), textures_(textures),
      diagnostics_(diagnostics) {
    if (map.kind == Node::Kind::map) {
        map_ = &map;
        taken_.resize(map.members.size());
    } else {
        diagnostics_.error(codes::kWrongKind, map.location,
                           subject_ + ": must be a map of keys" +
                               (map.kind == Node::Kind::null
                                    ? ", but has no value"
                                    : ", not " + std::string(kindName(map))));
        isOpen_ = false;
    }
}

const Node::Member* MapReader::takeMember(std::string_view key) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
    if (!map_) return nullptr;
    for (std::size_t i = 0; i < map_->members.size(); ++i)
        if (map_->members[i].key == key) {
            taken_[i] = true;
            return &map_->members[i];
        }
    return nullptr;
}

const Node* MapReader::take(std::string_view key) {
    const Node::Member* member = takeMember(key);
    return member ? &member->value : nullptr;
}

const Node* MapReader::require(std::string_view key) {
    const Node* node = take(key);
    if (!node) missing_.emplace_back(key);
    return node;
}

void MapReader::report(std::string_view key, const Fault& fault) {
    diagnostics_.error(fault.code, fault.location,
                       subject_ + ", " + std::string(key) + ": " + fault.clause, fault.suggestion);
}

std::optional<Value> MapReader::read(const Node& node, const rt_param& row) {
    Parsed<Value> parsed = parseValue(node, row);
    if (const auto* fault = std::get_if<Fault>(&parsed)) {
        report(row.name, *fault);
        return std::nullopt;
    }
    Value value = std::get<Value>(std::move(parsed));
    if (row.type != RT_TEXTURE) return value;

    const std::string& name = std::get<std::string>(value.data);
    const auto found = textures_.indices.find(name);
    if (found == textures_.indices.end()) {
        const std::string near = nearest(name, textures_.names);
        report(row.name,
               {codes::kUnknownTexture, node.location, "there is no texture " + quoted(name),
                !near.empty()             ? "did you mean '" + near + "'?"
                : textures_.names.empty() ? "the scene has no section 'textures'"
                                          : ""});
        return std::nullopt;
    }
    value.data = static_cast<std::int64_t>(found->second);
    return value;
}

void MapReader::readSection(const Field& field, const Node::Member* member, void* section) {
    if (!member) {
        if (isRequired(field))
            missing_.emplace_back(field.row.name);
        else if (*field.row.fallback != '\0')
            applyDefaults(field.fields, section);
        return;
    }
    MapReader inner(member->value, member->keyLocation, subject_ + "." + field.row.name, textures_,
                    diagnostics_);
    inner.readFields(field.fields, section);
    inner.finish();
}

void MapReader::readChoiceOrOne(const Field& field, const Node& node, void* section) {
    std::string maps;
    for (const Field& alternative : field.fields)
        maps += " or {" + std::string(alternative.row.name) + ": ...}";
    if (node.kind == Node::Kind::scalar) {
        if (findField(field.fields, node.text)) {
            report(field.row.name,
                   {codes::kChoice, node.location, "'" + node.text + "' needs a value",
                    "write {" + node.text + ": ...}"});
            return;
        }
        Parsed<Value> parsed = parseValue(node, field.row);
        if (auto* fault = std::get_if<Fault>(&parsed)) {
            const std::size_t got = fault->clause.find(" (got");
            fault->clause.insert(std::min(got, fault->clause.size()), maps);
            report(field.row.name, *fault);
        } else {
            field.assign(section, std::get<Value>(parsed));
        }
        return;
    }
    if (node.kind != Node::Kind::map || node.members.size() != 1) {
        std::string choices;
        for (const std::string& choice : choicesOf(field.row))
            choices += (choices.empty() ? "" : ", ") + choice;
        report(field.row.name,
               {codes::kWrongKind, node.location, "must be one of " + choices + maps, {}});
        return;
    }
    const Node::Member& member = node.members.front();
    const Field* alternative = findField(field.fields, member.key);
    if (!alternative) {
        std::vector<std::string> names;
        for (const Field& known : field.fields) names.emplace_back(known.row.name);
        const std::string near = nearest(member.key, names);
        diagnostics_.error(codes::kUnknownKey, member.keyLocation,
                           subject_ + "." + field.row.name + " has no key " + quoted(member.key),
                           near.empty() ? "it has " + enumerate(names)
                                        : "did you mean '" + near + "'?");
        return;
    }
    MapReader inner(node, member.keyLocation, subject_ + "." + field.row.name, textures_,
                    diagnostics_);
    if (const auto value = inner.read(member.value, alternative->row))
        alternative->assign(section, *value);
}

void MapReader::readOneOrMany(const Field& field, const Node::Member& member, void* section) {
    const auto readOne = [&](const Node& map, const Location& place, const std::string& subject) {
        MapReader inner(map, place, subject, textures_, diagnostics_);
        inner.readFields(field.fields, field.append(section));
        inner.finish();
    };
    const std::string subject = subject_ + ", " + field.row.name;
    if (member.value.kind != Node::Kind::sequence)
        return readOne(member.value, member.keyLocation, subject);
    for (std::size_t i = 0; i < member.value.items.size(); ++i)
        readOne(member.value.items[i], member.value.items[i].location,
                subject + "[" + std::to_string(i) + "]");
}

void MapReader::readFields(std::span<const Field> fields, void* section) {
    for (const Field& field : fields) {
        if (field.form == Form::byHand) continue;
        const Node::Member* member = takeMember(field.row.name);
        if (field.form == Form::section) {
            readSection(field, member, section);
        } else if (!member) {
            if (isRequired(field))
                missing_.emplace_back(field.row.name);
            else if (*field.row.fallback != '\0' && field.assign)
                field.assign(section, coreDefault(field.row));
        } else if (field.form == Form::choiceOrOne) {
            readChoiceOrOne(field, member->value, section);
        } else if (field.form == Form::oneOrMany) {
            readOneOrMany(field, *member, section);
        } else if (const auto value = read(member->value, field.row)) {
            field.assign(section, *value);
        }
    }
}

std::vector<Value> MapReader::readRows(std::span<const rt_param> rows) {
    std::vector<Value> values;
    values.reserve(rows.size());
    for (const rt_param& row : rows) {
        const Node* node = take(row.name);
        Value value;
        if (node) {
            value = read(*node, row).value_or(Value{});
        } else if (!row.fallback) {
            missing_.emplace_back(row.name);
        } else {
            Parsed<Value> parsed = parseFallback(row);
            if (auto* fault = std::get_if<Fault>(&parsed)) {
                fault->location = place_;
                fault->code = codes::kBadFallback;
                fault->clause = "the plugin's own default " + fault->clause;
                report(row.name, *fault);
            } else {
                value = std::get<Value>(std::move(parsed));
            }
        }
        if (!value.location.source) value.location = place_;
        values.push_back(std::move(value));
    }
    return values;
}

void MapReader::finish() {
    if (!isOpen_) return;
    std::vector<std::string> free; // known keys that the map does not have
    for (const std::string& key : known_)
        if (!map_->find(key)) free.push_back(key);
    for (std::size_t i = 0; i < map_->members.size(); ++i) {
        if (taken_[i]) continue;
        const Node::Member& member = map_->members[i];
        const std::string near = nearest(member.key, free);
        std::erase(missing_, near); // most likely misspelt, not missing
        diagnostics_.error(codes::kUnknownKey, member.keyLocation,
                           subject_ + " has no key " + quoted(member.key),
                           !near.empty()    ? "did you mean '" + near + "'?"
                           : known_.empty() ? "it has no keys"
                                            : "it has " + enumerate(known_));
    }
    for (const std::string& key : missing_)
        diagnostics_.error(codes::kMissingKey, place_, subject_ + " needs the key '" + key + "'");
    isOpen_ = false;
}

} // namespace rt::scene
