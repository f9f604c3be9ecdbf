//! The macro with which [`tree`](super::tree) defines each setting once, with all its properties.
//!
//! ```text
//! /// What the group is about.
//! group: GroupSettings {
//!     /// What the setting does.
//!     field = DEFAULT, number ("group.name" | "short", "unit", LEAST..=GREATEST);
//!     field = DEFAULT, choice ("group.name", TypeOfTheChoice);
//! }
//! ```

/// Generates the types of the groups, the type [`Settings`](super::Settings), and the tables of groups and fields.
macro_rules! settings_tree {
    ($(
        $(#[doc = $group_about:literal])+
        $group:ident: $Group:ident {
            $(
                $(#[doc = $about:literal])+
                $field:ident = $default:expr, $kind:ident $spec:tt;
            )+
        }
    )+) => {
        $(
            $(#[doc = $group_about])+
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $Group {
                $(
                    $(#[doc = $about])+
                    pub $field: value_type!($kind $spec),
                )+
            }

            impl Default for $Group {
                fn default() -> Self {
                    Self { $($field: $default),+ }
                }
            }
        )+

        /// Everything that can be set.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Settings {
            $(
                $(#[doc = $group_about])+
                pub $group: $Group,
            )+
        }

        /// All groups, in the order in which they are shown.
        pub static GROUPS: &[Group] = &[
            $(Group { name: stringify!($group), about: concat!($($group_about),+).trim_ascii_start() }),+
        ];

        /// All settings, in the order in which they are shown.
        pub static FIELDS: &[Field] = &[
            $($(
                field!($group.$field, concat!($($about),+).trim_ascii_start(), $kind $spec),
            )+)+
        ];
    };
}

macro_rules! value_type {
    (number $spec:tt) => {
        f32
    };
    (choice ($name:literal, $Choice:ty)) => {
        $Choice
    };
}

macro_rules! field {
    (
        $group:ident.$field:ident, $about:expr,
        number ($name:literal $(| $short:literal)?, $unit:literal, $min:literal..=$max:literal)
    ) => {
        Field {
            name: $name,
            short: [$(Some($short),)? None][0],
            unit: $unit,
            about: $about,
            kind: Kind::Number { min: $min, max: $max },
            read: |settings| settings.$group.$field,
            write: |settings, value| settings.$group.$field = value,
        }
    };
    ($group:ident.$field:ident, $about:expr, choice ($name:literal, $Choice:ty)) => {
        Field {
            name: $name,
            short: None,
            unit: "",
            about: $about,
            kind: Kind::Choice(<$Choice as Choice>::NAMES),
            read: |settings| settings.$group.$field.index() as f32,
            write: |settings, index| {
                if let Some(value) = <$Choice as Choice>::ALL.get(index as usize) {
                    settings.$group.$field = *value;
                }
            },
        }
    };
}
