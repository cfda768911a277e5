//! Sheets, text and PNG.

use isostudy_raster::tiny_skia::{Color, Pixmap};
use isostudy_raster::{
    Caption, Panel, PanelError, Sheet, TextStyle, draw_text, panels, pixmap_from_png, pixmap_to_png,
    text_width,
};

fn red(width: u32, height: u32) -> Pixmap {
    let mut pixmap = Pixmap::new(width, height).unwrap();
    pixmap.fill(Color::from_rgba8(255, 0, 0, 255));
    pixmap
}

fn is_red(sheet: &Pixmap, x: u32, y: u32) -> bool {
    sheet.pixel(x, y).map(|p| (p.red(), p.green(), p.blue())) == Some((255, 0, 0))
}

#[test]
fn pictures_stand_in_rows() {
    let picture = red(30, 20);
    let list = [Panel { picture: &picture, label: "" }; 5];
    let sheet = panels(&list, &Sheet { columns: 3, gap_px: 4, ..Sheet::default() }).unwrap();
    assert_eq!((sheet.width(), sheet.height()), (3 * 34 + 4, 2 * 24 + 4));
    for (x, y, expected) in
        [(4, 4, true), (3, 4, false), (33, 23, true), (34, 23, false), (38, 28, true), (72, 28, false)]
    {
        assert_eq!(is_red(&sheet, x, y), expected, "{x}, {y}");
    }
    assert!(sheet.pixels().iter().all(|p| p.alpha() == 255));
}

#[test]
fn captions_stand_under_or_above_and_break_between_words() {
    let picture = red(60, 20);
    let height = |caption, label| {
        let sheet = Sheet { caption, gap_px: 4, text_px: 10.0, ..Sheet::default() };
        let page = panels(&[Panel { picture: &picture, label }], &sheet).unwrap();
        let first_red = (0..page.height()).find(|&y| is_red(&page, 30, y)).unwrap();
        let ink = page.pixels().iter().filter(|p| p.red() < 100).count();
        (page.height(), first_red, ink > 10)
    };
    // A line of 10 pixels takes 1.45 of them, two take 2.6.
    assert_eq!(height(Caption::Under, "one"), (28 + 15, 4, true));
    assert_eq!(height(Caption::Above, "one"), (28 + 15, 4 + 15, true));
    assert_eq!(height(Caption::Above, "one and two more"), (28 + 26, 4 + 26, true));
}

#[test]
fn text_is_as_wide_as_it_says_and_stays_in_the_picture() {
    let width = text_width("Hamburg", 20.0);
    assert!((text_width("HamburgHamburg", 20.0) - 2.0 * width).abs() < 1.0);
    assert!((text_width("Hamburg", 40.0) - 2.0 * width).abs() < 0.1);
    let mut page = Pixmap::new(width as u32 + 40, 40).unwrap();
    page.fill(Color::WHITE);
    draw_text(&mut page, "Hamburg", 20.0, 25.0, &TextStyle { size_px: 20.0, ink: [0; 3] });
    let dark: Vec<u32> =
        (0..page.width()).filter(|&x| (0..40).any(|y| page.pixel(x, y).unwrap().red() < 128)).collect();
    assert!(dark[0] >= 20 && dark[dark.len() - 1] <= 20 + width as u32 + 1, "{dark:?}");
    draw_text(&mut page, "outside", -30.0, -3.0, &TextStyle { size_px: 20.0, ink: [0; 3] });
    draw_text(&mut page, "outside", 1e6, 60.0, &TextStyle { size_px: 20.0, ink: [0; 3] });
}

#[test]
fn nothing_to_lay_out_is_a_typed_error() {
    let picture = red(3, 3);
    assert!(matches!(panels(&[], &Sheet::default()), Err(PanelError::Empty { panels: 0, .. })));
    let none = Sheet { columns: 0, ..Sheet::default() };
    let list = [Panel { picture: &picture, label: "a" }];
    assert!(matches!(panels(&list, &none), Err(PanelError::Empty { columns: 0, .. })));
    let huge = Sheet { gap_px: 40_000, ..Sheet::default() };
    assert!(matches!(panels(&list, &huge), Err(PanelError::TooLarge { width: 80_003, .. })));
}

#[test]
fn a_png_is_opaque_and_the_same_picture() {
    let mut picture = red(7, 5);
    picture.data_mut()[20..24].copy_from_slice(&[1, 2, 3, 255]);
    let png = pixmap_to_png(&picture);
    assert_eq!(png[25], 2, "colour type red, green, blue");
    assert_eq!(pixmap_from_png(&png).unwrap().data(), picture.data());
    assert!(matches!(pixmap_from_png(b"no"), Err(PanelError::Png(_))));
}
