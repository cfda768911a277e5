# What the fetching scripts share; they source it. `say` is theirs, and `work` a folder of theirs that is removed at the end.

have() { command -v "$1" >/dev/null 2>&1; }

sha256() {
    if have sha256sum; then sha256sum <"$1" | cut -d' ' -f1
    elif have shasum; then shasum -a 256 <"$1" | cut -d' ' -f1
    else openssl dgst -sha256 <"$1" | sed 's/.*= *//'; fi
}

# unpack pypi|debian|npm PACKAGE: prints the folder with the package's files, fetched once.
unpack() {
    tree=$work/$(printf '%s' "$2" | tr -c 'A-Za-z0-9\n' _)
    if [ ! -d "$tree" ]; then
        mkdir -p "$tree.get"
        if [ "$1" = pypi ]; then
            python=$(command -v python3 || command -v python) || { say "$2: python is not installed"; return 1; }
            "$python" -m pip download --quiet --disable-pip-version-check --timeout 15 --retries 1 --no-deps \
                --only-binary=:all: --dest "$tree.get" "$2" >"$work/log" 2>&1 ||
                { say "$2: $(tail -n 1 "$work/log")"; return 1; }
            mkdir "$tree.part" && "$python" -m zipfile -e "$tree.get"/*.whl "$tree.part" || return 1
        elif [ "$1" = npm ]; then
            have npm || { say "$2: npm is not installed"; return 1; }
            (cd "$tree.get" && npm pack --loglevel=error --fetch-retries=1 --fetch-timeout=20000 "$2") >"$work/log" 2>&1 ||
                { say "$2: npm pack failed: $(grep error "$work/log" | grep -v ' code \| errno ' | head -n 1)"; return 1; }
            mkdir "$tree.part" && tar -xzf "$tree.get"/*.tgz -C "$tree.part" || return 1
        else
            have apt-get && have dpkg-deb || { say "$2: apt-get and dpkg-deb are not installed"; return 1; }
            (cd "$tree.get" && apt-get -qq -o Acquire::Retries=1 -o Acquire::http::Timeout=15 download "$2") \
                >"$work/log" 2>&1 || { say "$2: $(tail -n 1 "$work/log") (apt-get update first?)"; return 1; }
            mkdir "$tree.part" && dpkg-deb -x "$tree.get"/*.deb "$tree.part" || return 1
        fi
        mv "$tree.part" "$tree"
    fi
    printf '%s\n' "$tree"
}
