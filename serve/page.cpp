#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "serve/page_files.hpp"

namespace twinchute::serve {
namespace {

std::string_view file(std::string_view name) {
    for (const std::span<const compare::PageFile> files : {page_files(), compare::page_files()})
        if (const auto found = std::ranges::find(files, name, &compare::PageFile::name); found != files.end())
            return found->content;
    throw std::logic_error(fmt::format("the page names '{}', which no file of it is", name));
}

/// Each `before` NAME `after` becomes `open` and the content of that file and `close`.
std::string with_files(std::string_view html, std::string_view before, std::string_view after,
                       std::string_view open, std::string_view close) {
    std::string whole;
    for (;;) {
        const std::size_t at = html.find(before);
        whole += html.substr(0, at);
        if (at == html.npos) return whole;
        html.remove_prefix(at + before.size());
        const std::size_t end = html.find(after);
        whole += open;
        whole += file(html.substr(0, end));
        whole += close;
        html.remove_prefix(end + after.size());
    }
}

}  // namespace

std::string page_html() {
    const std::string styled =
        with_files(file("page.html"), "<link rel=\"stylesheet\" href=\"", "\">", "<style>\n", "</style>");
    return with_files(styled, "<script src=\"", "\"></script>", "<script>\n", "\n</script>");
}

}  // namespace twinchute::serve
