// The statements of a legacy scene file and of a legacy movie file, as parsed: every number with its place.
#pragma once
#include <converters/text.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rt::converters {

enum class Keyword : std::uint8_t {
    window,
    scene,
    camera,
    depth,
    smooth,
    antialias,
    texture,
    background,
    sphere,
    triangle,
    parallelogram,
    mesh,
    light,
    movie,
    save
};

/// MAT: color, diffuse, specular, transmission, environment (3 each), refractivity, shininess.
inline constexpr std::size_t kMaterialNumbers = 17;
using MaterialNumbers = std::array<Number, kMaterialNumbers>;
/// "diffuse g", as the report calls them.
std::string_view materialNumberName(std::size_t index);

struct Statement {
    Keyword keyword{};
    Word spelled;                // the keyword as written
    std::vector<Word> words;     // mesh: file, name, mode; texture, movie, save: file
    std::vector<Number> numbers; // its own, in file order
    std::optional<MaterialNumbers> material;
    std::optional<Word> name; // of a sphere, triangle or rect, which need none
    std::string text;         // as written, on one line
};

enum class MotionType : std::uint8_t { rotate, rotateSelf, move, moveRadius, moveDirect };
enum class CameraPoint : std::uint8_t { position, front, top };

struct MovieStatement {
    enum class Kind : std::uint8_t { header, fade, motion };
    Kind kind = Kind::header;
    Word spelled;
    std::optional<CameraPoint> camera;            // motion: of the camera, else of objects
    std::array<std::uint64_t, 2> objectNumbers{}; // inclusive
    MotionType type{};
    std::vector<Number> numbers; // header: frames fps; fade: texture fs fe; motion: arguments fs fe
    std::string text;
};

/// A comment; where its text alone is a statement, that statement.
template <class S> struct Comment {
    std::string text; // without its '#'
    scene::Location location;
    std::optional<S> statement;
};

template <class S> struct Commented {
    std::vector<Comment<S>> before;
    S statement;
    std::optional<Comment<S>> after; // on the line where the statement ends
};

template <class S> struct Parsed {
    std::vector<Commented<S>> statements;
    std::vector<Comment<S>> tail; // comments below the last statement
};

using SceneText = Parsed<Statement>;
using MovieText = Parsed<MovieStatement>;

/// Errors E0380 to E0389. With `lenient` the original's rules, each use a note.
SceneText parseSceneText(const std::shared_ptr<const scene::Source>& source, bool lenient,
                         scene::Diagnostics& diagnostics);
MovieText parseMovieText(const std::shared_ptr<const scene::Source>& source, bool lenient,
                         scene::Diagnostics& diagnostics);

/// Does the first statement that only one kind of file can hold belong to a movie file?
bool looksLikeMovie(const std::shared_ptr<const scene::Source>& source);

} // namespace rt::converters
