//! What has to be true of the process before the first graphics instance is made.

/// Gives Mesa the variable whose absence it reports on standard error.
///
/// Its Wayland code complains where `XDG_RUNTIME_DIR` is not an absolute path, as it is not in
/// containers and over plain SSH, and that line would land in the middle of a terminal interface.
/// The variable is set to its usual value, whether or not that folder exists, and the program
/// replaces its own image once: setting a variable of a running process is not sound in Rust.
pub fn prepare() {
    #[cfg(unix)]
    unix::prepare();
}

/// The program as it was called, to be shown in commands to type.
pub fn program() -> String {
    let called = std::env::args_os().next().map(|name| name.to_string_lossy().into_owned());
    called.filter(|name| !name.is_empty()).unwrap_or_else(|| "phystalk".to_owned())
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::MetadataExt;
    use std::os::unix::process::CommandExt;
    use std::process::Command;

    const VARIABLE: &str = "XDG_RUNTIME_DIR";

    pub fn prepare() {
        if std::env::var_os(VARIABLE).is_some_and(|v| std::path::Path::new(&v).is_absolute()) {
            return;
        }
        let (Ok(program), Ok(process)) = (std::env::current_exe(), std::fs::metadata("/proc/self")) else { return };
        let mut arguments = std::env::args_os();
        let name = arguments.next().unwrap_or_else(|| program.clone().into());
        // Returns only where it failed, and then nothing is lost but the quiet.
        let _ = Command::new(program).arg0(name).args(arguments).env(VARIABLE, format!("/run/user/{}", process.uid())).exec();
    }
}
