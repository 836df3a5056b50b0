#include "compare/report/still_page.hpp"

#include <fmt/format.h>

#include "compare/render/escape.hpp"
#include "compare/report/page_files.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::compare {

std::string page_section(const std::string& id, const std::string& title, const std::string& body) {
    return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title, body);
}

std::string page_figure(const Plot& plot) {
    return "<figure>" + svg_plot(plot) + "</figure>\n";
}

std::string still_page(const std::string& title, const std::string& what, const std::string& sections) {
    // Nothing may be fetched, sent or framed, whatever a name in a file manages to smuggle in.
    constexpr const char* policy =
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";
    const Provenance made = current_provenance();
    return fmt::format(
               "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
               "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
               "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
               "<meta name=\"color-scheme\" content=\"light dark\">\n"
               "<meta name=\"generator\" content=\"twinchute\">\n<title>{}, {} - twinchute</title>\n"
               "<style>\n{}</style>\n</head>\n<body>\n<main>\n"
               "<header><p class=\"brand\">twinchute <span>{}</span></p>\n<h1>{}</h1></header>\n",
               policy, xml_text(title), xml_text(what), page_file("report.css"), xml_text(what),
               xml_text(title)) +
           sections +
           fmt::format("<footer><p>twinchute {} ({})</p></footer>\n</main>\n</body>\n</html>\n",
                       xml_text(made.version), xml_text(made.commit));
}

}  // namespace twinchute::compare
