//! A page of its own: no file, script or font from elsewhere; light and dark as the reader's system has it, and for paper.

/// A page that is being written.
pub struct Page {
    title: String,
    body: String,
    contents: Vec<(String, String)>,
}

/// Text for a page.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const STYLE: &str = "
:root { color-scheme: light dark; --paper: #f7f8fa; --ink: #1b1e23; --dim: #5e646c; --line: #cdd2d9; --stripe: #e8eaee; --warn: #8a5a00 }
@media (prefers-color-scheme: dark) {
  :root { --paper: #1b1e23; --ink: #e6e8eb; --dim: #9aa1aa; --line: #363b44; --stripe: #252930; --warn: #f2b134 }
}
@media print { :root { --paper: #fff; --ink: #000; --dim: #444; --line: #bbb; --stripe: #eee } nav { display: none }
  section { break-inside: avoid-page } }
body { background: var(--paper); color: var(--ink); font: 15px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 76rem; padding: 1.5rem }
h1 { font-size: 1.6rem; margin: 0 } h2 { border-top: 1px solid var(--line); font-size: 1.2rem; margin-top: 2.2rem; padding-top: .8rem }
nav a { color: inherit; margin-right: 1rem } p, figcaption { color: var(--dim); max-width: 60rem } .warn { color: var(--warn) }
.scroll { overflow-x: auto } table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .6rem 0 }
th { border-bottom: 1px solid var(--line); color: var(--dim); font-weight: 500; text-align: right; vertical-align: bottom }
td { text-align: right } th, td { padding: .2rem .7rem; white-space: nowrap } td:first-child, th:first-child { padding-left: 0; text-align: left }
tr:nth-child(even) td { background: var(--stripe) } td.words, th.words { text-align: left; white-space: normal }
figure { display: inline-block; margin: .5rem 1rem .5rem 0; vertical-align: top } figure img { display: block; max-width: 100% }
figure svg { display: block; height: auto; max-width: 100% } code { background: var(--stripe); padding: .1rem .3rem } pre { overflow-x: auto }
";

impl Page {
    /// An empty page.
    pub fn new(title: &str, about: &str) -> Self {
        let body = format!("<h1>{}</h1>\n<p>{}</p>\n", escaped(title), escaped(about));
        Self { title: title.to_owned(), body, contents: Vec::new() }
    }

    /// Begins a section.
    pub fn section(&mut self, title: &str) {
        let id: String = title.chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect();
        self.body += &format!("<h2 id=\"{id}\">{}</h2>\n", escaped(title));
        self.contents.push((id, title.to_owned()));
    }

    /// A sentence or more.
    pub fn text(&mut self, text: &str) {
        self.body += &format!("<p>{}</p>\n", escaped(text));
    }

    /// A sentence that matters.
    pub fn warning(&mut self, text: &str) {
        self.body += &format!("<p class=\"warn\">! {}</p>\n", escaped(text));
    }

    /// Rows under headers. A header that ends in a point begins a column of words.
    pub fn table(&mut self, headers: &[&str], rows: &[Vec<String>]) {
        let words: Vec<bool> = headers.iter().map(|header| header.ends_with('.')).collect();
        let class = |k: usize| if words.get(k).copied().unwrap_or(false) { " class=\"words\"" } else { "" };
        let cell = |tag: &str, k: usize, text: &str| format!("<{tag}{}>{}</{tag}>", class(k), escaped(text));
        let head: String = headers.iter().enumerate().map(|(k, text)| cell("th", k, text.trim_end_matches('.'))).collect();
        self.body += &format!("<div class=\"scroll\"><table><thead><tr>{head}</tr></thead><tbody>\n");
        for row in rows {
            let cells: String = row.iter().enumerate().map(|(k, text)| cell("td", k, text)).collect();
            self.body += &format!("<tr>{cells}</tr>\n");
        }
        self.body += "</tbody></table></div>\n";
    }

    /// A plot, in the page's colours.
    pub fn plot(&mut self, svg: &str, caption: &str) {
        let svg = svg.replace("fill=\"#FFFFFF\"", "fill=\"var(--paper)\"");
        let svg = svg.replace("\"#000000\"", "\"var(--ink)\"");
        let caption = escaped(caption);
        self.body += &format!("<figure role=\"img\" aria-label=\"{caption}\">{svg}<figcaption>{caption}</figcaption></figure>\n");
    }

    /// A picture, as the bytes of a PNG file.
    pub fn picture(&mut self, png: &[u8], caption: &str) {
        use base64::Engine;
        let data = base64::engine::general_purpose::STANDARD.encode(png);
        let caption = escaped(caption);
        let image = format!("<img alt=\"{caption}\" src=\"data:image/png;base64,{data}\">");
        self.body += &format!("<figure>{image}<figcaption>{caption}</figcaption></figure>\n");
    }

    /// Lines to be typed.
    pub fn commands(&mut self, lines: &[String]) {
        self.body += &format!("<pre><code>{}</code></pre>\n", escaped(&lines.join("\n")));
    }

    /// The whole page.
    pub fn finish(self) -> String {
        let link = |(id, title): &(String, String)| format!("<a href=\"#{id}\">{}</a>", escaped(title));
        let contents: String = self.contents.iter().map(link).collect::<Vec<_>>().join("\n");
        let (head, rest) = self.body.split_once("<h2").unwrap_or((&self.body, ""));
        let rest = if rest.is_empty() { String::new() } else { format!("<h2{rest}") };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
             {head}<nav>{contents}</nav>\n{rest}</body>\n</html>\n",
            escaped(&self.title)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_the_user_is_taken_for_markup_and_nothing_is_fetched() {
        let mut page = Page::new("<b>.ply", "a & b");
        page.section("What is <it>?");
        page.table(&["name", "why."], &[vec!["<script>".into(), "x > y".into()]]);
        page.plot("<svg><rect fill=\"#FFFFFF\" stroke=\"#000000\"/></svg>", "a \"plot\"");
        page.picture(b"PNG", "a picture");
        page.warning("watch out");
        page.commands(&["boxwood report <b>.ply".to_owned()]);
        let html = page.finish();
        assert!(!html.contains("<script") && !html.contains("<b>") && !html.contains("http") && !html.contains("#FFFFFF"));
        assert!(html.contains("<nav><a href=\"#what-is--it--\">") && html.contains("class=\"words\">x &gt; y</td>"));
        assert_eq!(html.matches("<h2").count(), 1);
        assert!(html.find("<nav>") < html.find("<h2"));
    }
}
