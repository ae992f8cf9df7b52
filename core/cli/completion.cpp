// rt completion: scripts made of the same options that are parsed.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>

#include <algorithm>

namespace rt::cli {

namespace {

/// "none|fsaa4|grid=N" -> none fsaa4 grid=
std::vector<std::string> choicesOf(const std::string& value) {
    std::vector<std::string> choices;
    if (value.find('|') == std::string::npos) return choices;
    for (std::size_t from = 0; from <= value.size();) {
        const std::size_t to = std::min(value.find('|', from), value.size());
        std::string choice = value.substr(from, to - from);
        if (const std::size_t equals = choice.find('='); equals != std::string::npos)
            choice.resize(equals + 1);
        choices.push_back(choice);
        from = to + 1;
    }
    return choices;
}

std::vector<std::string> argumentWords(const CommandDescription& command,
                                       const std::vector<CommandDescription>& all) {
    std::vector<std::string> words;
    if (command.name == "completion") words = {"bash", "zsh", "fish"};
    if (command.name == "mesh") words = {"repair"};
    if (command.name == "help")
        for (const CommandDescription& other : all)
            if (other.name != "rt") words.push_back(other.name);
    return words;
}

/// Files the first argument may name, as shell globs; empty: any file or none.
std::string argumentGlob(const CommandDescription& command) {
    if (command.arguments.empty()) return "";
    const std::string& value = command.arguments[0].value;
    return value == "SCENE" ? "*.@(yaml|yml)" : command.name == "convert" ? "*.@(inf|INF)" : "";
}

bool namesFile(const std::string& value) {
    return value == "FILE" || value == "SCENE" || value == "A" || value == "B";
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

/// For use between single quotes.
std::string shellQuoted(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out;
}

// ---- bash ---------------------------------------------------------------------------------------------------

std::string bash(const std::vector<CommandDescription>& all) {
    std::string commands, rootOptions, cases;
    for (const CommandDescription& command : all) {
        std::string options, values;
        for (const OptionDescription& option : command.options) {
            options += " " + joined(option.names);
            if (option.value.empty()) continue;
            std::string names;
            for (const std::string& name : option.names) names += (names.empty() ? "" : "|") + name;
            const auto choices = choicesOf(option.value);
            const std::string answer =
                !choices.empty()
                    ? "COMPREPLY=($(compgen -W '" + joined(choices) + "' -- \"$word\"))"
                : option.value == "FILE"
                    ? "compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\"))"
                : option.value == "DIR"
                    ? "compopt -o filenames; COMPREPLY=($(compgen -d -- \"$word\"))"
                    : "COMPREPLY=()";
            values += "        " + names + ") " + answer + "; return ;;\n";
        }
        if (command.name == "rt") {
            rootOptions = options.substr(1);
            continue;
        }
        commands += " " + command.name;
        const auto words = argumentWords(command, all);
        const std::string glob = argumentGlob(command);
        std::string arguments = "COMPREPLY=()";
        if (!words.empty()) {
            arguments = "COMPREPLY=($(compgen -W '" + joined(words) + "' -- \"$word\"))";
        } else if (!glob.empty()) {
            arguments = "shopt -q extglob || local restore=1; shopt -s extglob; compopt -o "
                        "filenames; COMPREPLY=($(compgen -f -X '!" +
                        glob +
                        "' -- \"$word\") $(compgen -d -- \"$word\")); [[ -n ${restore-} ]] && "
                        "shopt -u extglob";
        } else if (!command.arguments.empty() && namesFile(command.arguments[0].value)) {
            arguments = "compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\"))";
        }
        cases += "    " + command.name + ")\n        case $previous in\n" + values +
                 "        esac\n        if [[ $word == -* ]]; then COMPREPLY=($(compgen -W '" +
                 options.substr(1) + " ROOT' -- \"$word\")); else " + arguments + "; fi ;;\n";
    }
    for (std::size_t at; (at = cases.find(" ROOT'")) != std::string::npos;)
        cases.replace(at, 6, " " + rootOptions + "'");
    // Bash splits words at '=': `--shade=n` arrives as three.
    return R"(# bash completion of rt; made by `rt completion bash`
_rt() {
    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command= i
    if [[ $word == = ]]; then
        word=
    elif [[ $previous == = ]]; then
        previous=${COMP_WORDS[COMP_CWORD-2]}
    fi
    for ((i = 1; i < COMP_CWORD; ++i)); do
        [[ ${COMP_WORDS[i]} != -* ]] && { command=${COMP_WORDS[i]}; break; }
    done
    COMPREPLY=()
    case $command in
)" + cases +
           "    '') COMPREPLY=($(compgen -W '" + commands.substr(1) + " " + rootOptions +
           "' -- \"$word\")) ;;\n    esac\n}\ncomplete -F _rt rt\n";
}

// ---- zsh ----------------------------------------------------------------------------------------------------

std::string zshText(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
        out += c;
    }
    return shellQuoted(out);
}

std::string zshValue(const std::string& value) {
    const auto choices = choicesOf(value);
    if (!choices.empty()) return ":value:(" + joined(choices) + ")";
    if (value == "FILE" || value == "A" || value == "B") return ":file:_files";
    if (value == "SCENE") return ":scene:_files -g \"*.(yaml|yml)\"";
    if (value == "DIR") return ":folder:_files -/";
    return ":" + zshText(value) + ":";
}

std::string zshOptions(const CommandDescription& command) {
    std::string text;
    for (const OptionDescription& option : command.options)
        for (const std::string& name : option.names)
            text += " \\\n            '*" + name +
                    (option.value.empty() || name.size() == 2 ? "" : "=") + "[" +
                    zshText(option.text) + "]" +
                    (option.value.empty() ? "" : zshValue(option.value)) + "'";
    return text;
}

std::string zsh(const std::vector<CommandDescription>& all) {
    std::string commands, cases;
    const std::string root = zshOptions(all[0]);
    for (const CommandDescription& command : all) {
        if (command.name == "rt") continue;
        commands += "        '" + command.name + ":" + zshText(command.text) + "'\n";
        cases += "    " + command.name + ")\n        _arguments -s" + zshOptions(command) + root;
        const auto words = argumentWords(command, all);
        if (!words.empty())
            cases += " \\\n            '*:word:(" + joined(words) + ")'";
        else if (!command.arguments.empty())
            cases += " \\\n            '*" +
                     (command.name == "convert" ? ":scene:_files -g \"*.(inf|INF)\""
                                                : zshValue(command.arguments[0].value)) +
                     "'";
        cases += " ;;\n";
    }
    return "#compdef rt\n# zsh completion of rt; made by `rt completion zsh`\n_rt() {\n    local "
           "-a commands\n    commands=(\n" +
           commands +
           "    )\n    if ((CURRENT == 2)); then\n        _describe command commands\n        "
           "_arguments -s" +
           root +
           "\n        return\n    fi\n    local command=$words[2]\n    shift words; "
           "((CURRENT--))\n    case $command in\n" +
           cases + "    esac\n}\n_rt \"$@\"\n";
}

// ---- fish ---------------------------------------------------------------------------------------------------

std::string fishOption(const OptionDescription& option, const std::string& condition) {
    std::string text = "complete -c rt" + condition;
    for (const std::string& name : option.names)
        text += name.size() == 2 ? " -s " + name.substr(1) : " -l " + name.substr(2);
    const auto choices = choicesOf(option.value);
    if (!choices.empty())
        text += " -x -a '" + joined(choices) + "'";
    else if (option.value == "FILE")
        text += " -r -F";
    else if (option.value == "DIR")
        text += " -x -a '(__fish_complete_directories)'";
    else if (!option.value.empty())
        text += " -x";
    return text + " -d '" + shellQuoted(option.text) + "'\n";
}

std::string fish(const std::vector<CommandDescription>& all) {
    std::string text = "# fish completion of rt; made by `rt completion fish`\ncomplete -c rt -f\n";
    for (const OptionDescription& option : all[0].options) text += fishOption(option, "");
    for (const CommandDescription& command : all) {
        if (command.name == "rt") continue;
        text += "complete -c rt -n __fish_use_subcommand -a " + command.name + " -d '" +
                shellQuoted(command.text) + "'\n";
        const std::string condition = " -n '__fish_seen_subcommand_from " + command.name + "'";
        for (const OptionDescription& option : command.options)
            text += fishOption(option, condition);
        const auto words = argumentWords(command, all);
        if (!words.empty())
            text += "complete -c rt" + condition + " -x -a '" + joined(words) + "'\n";
        else if (!command.arguments.empty() && namesFile(command.arguments[0].value))
            text += "complete -c rt" + condition + " -F\n";
    }
    return text;
}

} // namespace

int completion(const CompletionOptions& options, Console& console) {
    const auto all = describeCommands();
    console.result(options.shell == "bash"  ? bash(all)
                   : options.shell == "zsh" ? zsh(all)
                                            : fish(all));
    return kExitOk;
}

} // namespace rt::cli
