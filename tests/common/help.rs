//! Whether the help of a command line says what happens without an option.

/// Options whose absence means that nothing is read, written or sent.
const FILES: [&str; 5] = ["FILE", "CLIP", "DIR", "INPUT", "HOST:PORT"];

/// Every option with a value shows its default, in this command and those below it.
pub fn check(command: &clap::Command) {
    command.get_subcommands().for_each(check);
    for option in command.get_opts() {
        let names = option.get_value_names().unwrap_or_default();
        let is_file = names.iter().any(|name| FILES.contains(&name.as_str()));
        let help = option
            .get_help()
            .map(ToString::to_string)
            .unwrap_or_default();
        let shows = !option.get_default_values().is_empty() || help.contains("[default: ");
        let takes_value = option.get_action().takes_values();
        assert!(
            !takes_value || is_file || shows || option.is_required_set(),
            "{} --{}: {help}",
            command.get_name(),
            option.get_id()
        );
    }
}
