//! The macro that generates structs, defaults, validation and the table of parameters from one text, so they cannot disagree.

/// The methods that read a parameter, each with the first stage that reads it.
macro_rules! readers {
    ([$($method:ident: $stage:ident),+]) => { &[$(Reader { method: Method::$method, first_stage: Stage::$stage }),+] };
}

/// A struct for every group, and `Params` with all groups.
macro_rules! parameters {
    ($(
        $(#[doc = $group_doc:literal])+
        $Group:ident $group:ident, read by $readers:tt {
            $(
                $(#[doc = $doc:literal])+
                $name:ident: $ty:ty = $default:expr, $allowed:expr, $unit:literal, $source:literal
                    $(, read by $own_readers:tt)?;
            )+
        }
    )+) => {
        $(
            $(#[doc = $group_doc])+
            #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
            #[serde(default, deny_unknown_fields)]
            pub struct $Group {
                $(
                    $(#[doc = $doc])+
                    #[doc = concat!("\n\nUnit: ", $unit, ". Default: `", stringify!($default), "` (", $source, ").")]
                    pub $name: $ty,
                )+
            }

            impl Default for $Group {
                fn default() -> Self {
                    Self { $($name: $default),+ }
                }
            }

            impl $Group {
                fn validate(&self) -> Result<()> {
                    $(check(concat!(stringify!($group), ".", stringify!($name)), &self.$name, &$allowed)?;)+
                    Ok(())
                }

                fn number(&self, name: &str) -> Option<f64> {
                    match name {
                        $(stringify!($name) => self.$name.number(),)+
                        _ => None,
                    }
                }

                fn set_number(&mut self, name: &str, number: f64) -> Option<()> {
                    match name {
                        $(stringify!($name) => self.$name = Number::from_number(number)?,)+
                        _ => return None,
                    }
                    Some(())
                }

                fn choice(&self, name: &str) -> Option<String> {
                    match name {
                        $(stringify!($name) => self.$name.choice(),)+
                        _ => None,
                    }
                }

                fn set_choice(&mut self, name: &str, choice: &str) -> Option<()> {
                    match name {
                        $(stringify!($name) => self.$name = Choice::from_choice(choice)?,)+
                        _ => return None,
                    }
                    Some(())
                }

                fn table() -> Vec<ParameterInfo> {
                    let defaults = Self::default();
                    vec![$(ParameterInfo {
                        name: concat!(stringify!($group), ".", stringify!($name)).to_owned(),
                        default: defaults.$name.to_string(),
                        range: Allowed::<$ty>::in_words(&$allowed),
                        unit: $unit,
                        meaning: [$($doc.trim()),+].join(" "),
                        source: $source,
                        readers: Self::readers(stringify!($name)),
                    }),+]
                }

                fn readers(name: &str) -> &'static [Reader] {
                    match name {
                        $($(stringify!($name) => readers!($own_readers),)?)+
                        _ => readers!($readers),
                    }
                }

                fn first_reader_of_change(&self, other: &Self, method: Method) -> Option<Stage> {
                    let changed = [$((self.$name != other.$name).then_some(stringify!($name))),+];
                    let readers = changed.into_iter().flatten().flat_map(Self::readers);
                    readers.filter(|reader| reader.method == method).map(|reader| reader.first_stage).min()
                }
            }
        )+

        /// All parameters, a group per algorithm. `Params::default()` is the method `context`.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct Params {
            /// The method.
            pub method: Method,
            $($(#[doc = $group_doc])+ pub $group: $Group,)+
        }

        impl Params {
            /// Checks every value against its range.
            ///
            /// # Errors
            /// [`Error::BadParameter`](crate::Error::BadParameter) names the first value outside its range.
            pub fn validate(&self) -> Result<()> {
                $(self.$group.validate()?;)+
                Ok(())
            }

            /// The value of the parameter `group.name`; `None` when it is not a number or there is no such parameter.
            pub fn number(&self, name: &str) -> Option<f64> {
                let (group, name) = name.split_once('.')?;
                match group {
                    $(stringify!($group) => self.$group.number(name),)+
                    _ => None,
                }
            }

            /// The same parameters with another value of the parameter `group.name`; `None` when it does not take that number.
            pub fn with_number(&self, name: &str, number: f64) -> Option<Self> {
                let (group, name) = name.split_once('.')?;
                let mut params = self.clone();
                match group {
                    $(stringify!($group) => params.$group.set_number(name, number)?,)+
                    _ => return None,
                }
                params.validate().is_ok().then_some(params)
            }

            /// The name that the parameter `group.name` has chosen, `true` or `false` for a switch; `None` when it is a number or there is no
            /// such parameter.
            pub fn choice(&self, name: &str) -> Option<String> {
                let (group, name) = name.split_once('.')?;
                match group {
                    $(stringify!($group) => self.$group.choice(name),)+
                    _ => None,
                }
            }

            /// The same parameters with another choice for the parameter `group.name`; `None` when it does not know that name.
            pub fn with_choice(&self, name: &str, choice: &str) -> Option<Self> {
                let (group, name) = name.split_once('.')?;
                let mut params = self.clone();
                match group {
                    $(stringify!($group) => params.$group.set_choice(name, choice)?,)+
                    _ => return None,
                }
                Some(params)
            }

            /// The first stage of a method that reads a parameter whose value differs; `None` when all parameters that it reads are equal.
            pub(crate) fn first_reader_of_change(&self, other: &Self, method: Method) -> Option<Stage> {
                let groups = [$(self.$group.first_reader_of_change(&other.$group, method)),+];
                groups.into_iter().flatten().min()
            }

            /// The table of all parameters, in the order in which the method uses them.
            pub fn table() -> Vec<ParameterInfo> {
                let groups = [$($Group::table()),+];
                groups.into_iter().flatten().collect()
            }
        }
    };
}
