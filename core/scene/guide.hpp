// The scene language as Markdown, from the table that parses it: scenes/LANGUAGE.md.
#pragma once
#include <string>

namespace rt::scene {

std::string languageGuide();

} // namespace rt::scene
