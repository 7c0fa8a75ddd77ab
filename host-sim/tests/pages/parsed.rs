//! A page as a browser reads it.

use scraper::{ElementRef, Html, Selector};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A page without errors of syntax.
pub struct ParsedPage {
    html: Html,
}

impl ParsedPage {
    /// Reads a page and checks what holds for each: valid HTML, one file, no dead links, figures
    /// with finite numbers.
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).expect("a page");
        let page = Self {
            html: Html::parse_document(&text),
        };
        assert!(page.html.errors.is_empty(), "{:?}", page.html.errors);
        page.is_one_file();
        assert!(text.len() < 1_500_000, "{} bytes", text.len());
        page
    }

    fn is_one_file(&self) {
        let ids: Vec<&str> = self
            .all("[id]")
            .iter()
            .filter_map(|of| of.attr("id"))
            .collect();
        let distinct: BTreeSet<&str> = ids.iter().copied().collect();
        assert_eq!(distinct.len(), ids.len(), "{ids:?}");
        assert!(self.all("[src], link, iframe, object, img").is_empty());
        for link in self.all("[href]") {
            let target = link.attr("href").unwrap_or_default();
            let id = target
                .strip_prefix('#')
                .unwrap_or_else(|| panic!("{target}"));
            assert!(distinct.contains(id), "{target}");
        }
        for style in self.all("style") {
            let text: String = style.text().collect();
            assert!(
                !text.contains("@import") && !text.contains("url("),
                "{text}"
            );
        }
        for drawing in self.all(".drawing") {
            let id = drawing.attr("data-of").expect("data");
            assert!(distinct.contains(id), "{id}");
        }
        // The browser itself refuses what is elsewhere.
        let policy = self.all("meta[http-equiv=Content-Security-Policy]");
        let policy = policy[0].attr("content").unwrap();
        assert!(policy.contains("default-src 'none'"), "{policy}");
    }

    /// Returns the elements that a CSS selector selects.
    pub fn all(&self, selector: &str) -> Vec<ElementRef<'_>> {
        let selector = Selector::parse(selector).expect("a selector");
        self.html.select(&selector).collect()
    }

    /// Returns the text of the elements that a CSS selector selects.
    pub fn texts(&self, selector: &str) -> Vec<String> {
        self.all(selector)
            .iter()
            .map(|of| of.text().collect())
            .collect()
    }

    /// Returns the data of a figure.
    pub fn figure(&self, name: &str) -> Value {
        let texts = self.texts(&format!("script#data-{name}"));
        assert_eq!(texts.len(), 1, "{name}");
        serde_json::from_str(&texts[0]).expect("JSON")
    }
}

/// Returns the points of a series of a chart; without those in gaps.
pub fn points(chart: &Value, series: &str) -> Vec<(f64, f64)> {
    let all = chart["series"].as_array().expect("series");
    let found = all.iter().find(|of| of["name"] == series);
    let found = found.unwrap_or_else(|| panic!("no {series}"));
    let axis = found["axis"].as_u64().expect("an index") as usize;
    let x = chart["axes"][axis].as_array().expect("x");
    let y = found["y"].as_array().expect("y");
    assert_eq!(x.len(), y.len());
    let pairs = x.iter().zip(y);
    pairs
        .filter_map(|(x, y)| Some((x.as_f64()?, y.as_f64()?)))
        .collect()
}
