//! A page of all kinds of parts, with text that could break it.

use super::parsed::{ParsedPage, points};
use host_sim::report::page::{Figure, Note, Page, Section, Table};
use host_sim::report::plan::{Colouring, Plan, PlanLine, PlanPoint};
use host_sim::report::plot::{Mark, Plot, Series, colour};
use host_sim::report::profile::ProfilePoint;
use test_kit::command::folder;

const ODD: &str = "<b>&\"'</script><!--";

fn written(page: &Page) -> ParsedPage {
    let folder = folder();
    let path = folder.path().join("index.html");
    page.stage_alone(&path).unwrap().commit().unwrap();
    ParsedPage::read(&path)
}

#[test]
fn odd_text_stays_text() {
    let plot = Plot::new(ODD, ODD).with(Series::line(ODD, colour::BLUE, [(0.0, 1.0), (1.0, 2.0)]));
    let plan = Plan {
        colourings: vec![Colouring::grades([1.0])],
        lines: vec![PlanLine {
            name: ODD.to_owned(),
            ..PlanLine::default()
        }],
    };
    let table = Table::new("table", ODD, &[ODD, "b"]).with_rows([vec![ODD.into(), "1".into()]]);
    let section = Section::new(ODD)
        .paragraph(ODD)
        .note(Note::warning(ODD, ODD))
        .note(Note::info(ODD))
        .table(table)
        .figure(Figure::new("plot", &plot, ODD))
        .figure(Figure::plan("plan", plan, ODD));
    let page = written(
        &Page::new(ODD, ODD)
            .with(section.clone())
            .with(Section::new("2")),
    );
    for place in [
        "h1",
        "h2",
        "p",
        "td",
        "th",
        ".note.warning span",
        "nav a",
        "title",
    ] {
        assert_eq!(page.texts(place)[0], ODD.to_owned(), "{place}");
    }
    assert!(
        page.texts("figcaption")
            .iter()
            .all(|caption| caption == ODD)
    );
    assert_eq!(page.figure("plot")["series"][0]["name"], ODD);
    assert_eq!(page.figure("plan")["lines"][0]["name"], ODD);
}

#[test]
fn long_curves_keep_their_extremes_and_say_so() {
    let peak = |i: usize| {
        if i == 77_777 {
            5.0
        } else {
            (i as f64 * 1e-3).sin()
        }
    };
    let points_of = (0..200_000).map(|i| ProfilePoint {
        distance_m: 2.5 * i as f64,
        value: peak(i),
        sigma: Some(0.1),
    });
    let plot = Plot::profile("grade (%)", "road").with_profile("map", colour::BLUE, points_of);
    let section = Section::new("Long").figure(Figure::new("long", &plot, "Grade."));
    let page = written(&Page::new("Long", "").with(section));
    let drawn = points(&page.figure("long"), "map");
    assert!(drawn.len() <= 10_010, "{}", drawn.len());
    assert!(drawn.iter().any(|point| point.1 == 5.0));
    assert!(page.texts("figcaption")[0].contains("the least and the greatest"));
}

#[test]
fn curves_beyond_the_axis_are_marked() {
    let line = Series::line("a", colour::BLUE, [(0.0, 0.0), (1.0, 3.0), (2.0, 0.0)]);
    let mut plot = Plot::new("x", "y").with(line);
    let caption = |plot: &Plot| Figure::new("a", plot, "A.").caption;
    assert_eq!(caption(&plot), "A.");
    let triangles = |plot: &Plot| plot.to_svg().matches("<polygon").count();
    assert_eq!(triangles(&plot), 0);
    plot.y_range = Some((-1.0, 1.0));
    assert_eq!(triangles(&plot), 1);
    assert!(caption(&plot).contains("leaves the axis"));
    let dashed = plot.series[0].clone().drawn(Mark::Dashed);
    assert_eq!(triangles(&plot.with(dashed)), 2);
}

#[test]
fn a_plan_knows_where_it_is() {
    let at = |i: i32| PlanPoint {
        latitude_deg: -17.0,
        longitude_deg: (179.99 + 0.001 * f64::from(i) + 180.0).rem_euclid(360.0) - 180.0,
        distance_m: 106.0 * f64::from(i),
        values: vec![f64::from(i)],
    };
    let plan = Plan {
        colourings: vec![Colouring::amounts("runs", "", (0..20).map(f64::from))],
        lines: vec![PlanLine {
            name: "Taveuni".to_owned(),
            link: "road".to_owned(),
            points: (0..20).map(at).collect(),
        }],
    };
    let section = Section::new("Plan").figure(Figure::plan("plan", plan, "Plan."));
    let plan = written(&Page::new("Plan", "").with(section)).figure("plan");
    // Across the date line, 2 km stay 2 km.
    let places: Vec<f64> = serde_json::from_value(plan["lines"][0]["places"].clone()).unwrap();
    let wide_m = places[38] - places[0];
    assert!((wide_m - 2020.0).abs() < 20.0, "{wide_m}");
    assert_eq!(plan["middle"][0], -17.0);
    let middle = plan["middle"][1].as_f64().unwrap();
    assert!((middle - 179.9995).abs() < 1e-6, "{middle}");
}

#[test]
fn a_page_of_words_carries_no_script() {
    let page = written(&Page::new("Words", "").with(Section::new("1").paragraph("Text.")));
    assert!(page.all("script").is_empty());
}
