//! Writes the page of all settings: `cargo run --quiet --example settings_page > docs/settings.md`.

fn main() {
    print!("{}", haptic_paddle::settings::Page);
}
