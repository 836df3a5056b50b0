#include "compare/report/glossary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string_view>
#include <vector>

#include "compare/render/escape.hpp"
#include "compare/report/page_files.hpp"

namespace twinchute::compare {
namespace {

struct Term {
    std::string name, meaning;  ///< the name in small letters, words one blank apart
};

/// The text of a Markdown cell without links and marks of code.
std::string plain(std::string_view cell) {
    std::string text;
    for (std::size_t i = 0; i < cell.size(); ++i) {
        if (cell[i] == '`' || cell[i] == '[') continue;
        if (cell.substr(i).starts_with("](")) {
            i = std::min(cell.find(')', i), cell.size());
            continue;
        }
        text += cell[i];
    }
    return text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t at = 1; at < line.size();) {
        const std::size_t end = std::min(line.find('|', at), line.size());
        std::string_view cell = line.substr(at, end - at);
        while (cell.starts_with(' '))
            cell.remove_prefix(1);
        while (cell.ends_with(' '))
            cell.remove_suffix(1);
        cells.push_back(cell);
        at = end + 1;
    }
    return cells;
}

/// Terms by name, longest first. One that means several things, "design (of a campaign)", is in none: a row's
/// heading does not say which.
std::vector<Term> read_terms(std::string_view glossary) {
    std::vector<Term> terms;
    std::map<std::string, int> uses;
    while (!glossary.empty()) {
        const std::size_t end = std::min(glossary.find('\n'), glossary.size() - 1);
        const std::string_view line = glossary.substr(0, end);
        glossary.remove_prefix(end + 1);
        if (!line.starts_with("| ") || line.starts_with("| ---") || line.starts_with("| term |")) continue;
        const std::vector<std::string_view> cells = cells_of(line);
        if (cells.size() < 4) continue;
        std::string names = plain(cells[0]);
        const std::size_t qualifier = names.find(" (");
        const std::string key = names.substr(0, qualifier);
        ++uses[key];
        if (qualifier != names.npos) continue;
        names += ", ";
        for (std::size_t at = 0, comma = 0; (comma = names.find(", ", at)) != names.npos; at = comma + 2)
            terms.push_back({names.substr(at, comma - at), plain(cells[3])});
    }
    std::erase_if(terms, [&](const Term& term) { return uses.contains(term.name) && uses[term.name] > 1; });
    std::ranges::stable_sort(terms, std::ranges::greater{}, [](const Term& t) { return t.name.size(); });
    return terms;
}

const std::vector<Term>& all_terms() {
    static const std::vector<Term> terms = read_terms(page_file("glossary.md"));
    return terms;
}

bool is_letter(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

/// Small letters, and blanks for hyphens and underscores: of the same length.
std::string folded(std::string_view text) {
    std::string small(text);
    for (char& c : small)
        c = c == '-' || c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return small;
}

using Found = std::map<std::string, const Term*>;

/// The text, already HTML, with its longest term explained.
std::string explained(std::string_view text, Found& found) {
    const std::string small = folded(text);
    for (const Term& term : all_terms()) {
        const std::size_t at = small.find(term.name), end = at + term.name.size();
        if (at == small.npos) continue;
        const std::size_t plural = end < small.size() && small[end] == 's' ? end + 1 : end;
        if ((at > 0 && is_letter(small[at - 1])) || (plural < small.size() && is_letter(small[plural])))
            continue;
        found.emplace(term.name, &term);
        return fmt::format("{}<abbr title=\"{}\">{}</abbr>{}", text.substr(0, at), xml_text(term.meaning),
                           text.substr(at, end - at), text.substr(end));
    }
    return std::string(text);
}

}  // namespace

std::string with_glossary(const std::string& body) {
    // Beginnings of elements whose text is a name.
    constexpr std::array<std::string_view, 3> openings{"<th scope=\"row\">", "<h3>", "<figcaption><strong>"};
    Found found;
    const std::string_view all = body;
    std::string page;
    page.reserve(2 * body.size());
    std::array<std::size_t, openings.size()> next{};  // place of each from `at` on
    for (std::size_t i = 0; i < openings.size(); ++i)
        next[i] = all.find(openings[i]);
    for (std::size_t at = 0; at < all.size();) {
        const auto first = std::ranges::min_element(next);
        const std::string_view opening = openings[static_cast<std::size_t>(first - next.begin())];
        const std::size_t name = *first == all.npos ? all.size() : *first + opening.size();
        page += all.substr(at, name - at);
        at = std::min(all.find('<', name), all.size());
        if (name < all.size()) page += explained(all.substr(name, at - name), found);
        *first = all.find(opening, at);
    }
    if (found.empty()) return page;
    page +=
        "<section id=\"words\"><h2>Words</h2>\n<details><summary>Meaning of the words that are underlined "
        "with dots</summary>\n<dl class=\"facts\">\n";
    for (const auto& [name, term] : found)
        page += fmt::format("<dt>{}</dt><dd>{}</dd>\n", xml_text(name), xml_text(term->meaning));
    return page + "</dl></details></section>\n";
}

}  // namespace twinchute::compare
