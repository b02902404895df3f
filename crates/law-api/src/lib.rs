//! What a contact law is: stages over chunks of contacts, parameters, history, oracle and the registry
