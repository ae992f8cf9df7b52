// A map of the scene while it is read: keys are taken by those who know them, and what nobody took is unknown.
#pragma once
#include <core/scene/language.hpp>
#include <core/scene/values.hpp>

#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace rt::scene {

/// The scene's textures, for keys that name one.
struct TextureNames {
    std::unordered_map<std::string, std::uint32_t> indices;
    std::vector<std::string> names; // in file order
};

class MapReader {
public:
    /// `place` is that of the map's key, where a missing key is reported; `subject` names the map in messages.
    /// A node that is no map is reported once and read as an empty one.
    MapReader(const Node& map, Location place, std::string subject, const TextureNames& textures,
              Diagnostics& diagnostics);

    /// The value of `key`, or null. Makes the key a known one.
    const Node* take(std::string_view key);
    const Node::Member* takeMember(std::string_view key);
    /// As take; reports the key as missing when it is.
    const Node* require(std::string_view key);
    bool has(std::string_view key) const { return map_ && map_->find(key) != nullptr; }

    /// Every field that is not read by hand, defaults where the file says nothing.
    void readFields(std::span<const Field> fields, void* section);
    std::vector<Value> readRows(std::span<const rt_param> rows);

    /// "SUBJECT, KEY: CLAUSE" at the fault's place.
    void report(std::string_view key, const Fault& fault);
    /// Unknown keys and missing keys. No key is known after it.
    void finish();
    /// For a map whose keys cannot be known, since its type could not be opened.
    void abandon() { isOpen_ = false; }

    const Location& place() const { return place_; }
    const std::string& subject() const { return subject_; }
    const TextureNames& textures() const { return textures_; }
    void rename(std::string subject) { subject_ = std::move(subject); }

private:
    std::optional<Value> read(const Node& node, const rt_param& row);
    void readSection(const Field& field, const Node::Member* member, void* section);
    void readChoiceOrOne(const Field& field, const Node& node, void* section);
    void readOneOrMany(const Field& field, const Node::Member& member, void* section);

    const Node* map_ = nullptr; // null: no map
    Location place_;
    std::string subject_;
    const TextureNames& textures_;
    Diagnostics& diagnostics_;
    std::vector<bool> taken_;
    std::vector<std::string> known_;
    std::vector<std::string> missing_;
    bool isOpen_ = true;
};

/// Gives every field of `fields` its default; fields without one keep what the struct has.
void applyDefaults(std::span<const Field> fields, void* section);

} // namespace rt::scene
