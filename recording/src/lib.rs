//! The recording format: folders of one TOML file and CSV runs.
